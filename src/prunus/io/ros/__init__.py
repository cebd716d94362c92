"""ROS bags: clouds and depth images out of them, skeletons into them."""
