"""Commands that draw what is in logs."""
