"""Files in and out: text, TOML, and results that appear whole or not at all."""
