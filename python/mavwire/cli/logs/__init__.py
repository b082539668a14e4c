"""Commands that read, convert and mend logs."""
