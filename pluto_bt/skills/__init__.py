"""The command chain and the controllers: state in, commands and status out. No blackboard, no threads, no clock."""
