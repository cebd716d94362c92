"""The browser room where a person looks, cleans, corrects and labels."""
