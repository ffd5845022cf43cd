"""Trees back to English."""
