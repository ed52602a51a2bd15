"""Any disc cam."""
