"""What a dialect is made of: its class, its reader line by line, how it is found and checked."""
