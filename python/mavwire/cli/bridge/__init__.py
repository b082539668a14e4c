"""Commands that route and send frames."""
