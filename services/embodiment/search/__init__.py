"""The search for a body motion: rounds until there is one, or a proof, or no hope; a refusal in words."""
