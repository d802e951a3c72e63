"""The window in a browser: a scene that a page changes, frames of it, and the server between them."""
