"""The same scenes in other codes, for developers: tools/slope bench (speed) and tools/slope crosscheck (results)."""
