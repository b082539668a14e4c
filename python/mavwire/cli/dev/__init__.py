"""Commands for developers: dialects, the alias and the names of scripts."""
