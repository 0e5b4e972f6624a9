"""What the page asks for, one file a group of addresses."""
