"""Reading and writing files so that nothing is ever half read or half written."""
