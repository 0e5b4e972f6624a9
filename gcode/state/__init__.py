"""What a control remembers: modes, position, tools and offsets, and the record of what it did."""
