"""What a capture covers and whether its photographs can be used, and the page that shows it."""
