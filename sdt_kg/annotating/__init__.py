"""What is inferred about models, and what files say of them that no model can."""
