"""The Law: three relations over a case; pure, given oracles."""
