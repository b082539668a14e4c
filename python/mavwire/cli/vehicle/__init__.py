"""Commands about one vehicle: simulate it, and its parameters, mission and compass."""
