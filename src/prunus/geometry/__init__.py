"""Arrays in, arrays out: what several rooms reckon with, on scipy, without a compiler."""
