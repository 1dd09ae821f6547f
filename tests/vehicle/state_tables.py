"""Tables of a state machine: a trigger a line, and where it leads to from each state."""


def state_table(rows):
    """Return the states of the first line, and trigger -> state -> next state; `.`: it stays."""
    (_, *states), *rest = (line.split() for line in rows.strip().splitlines())
    return states, {
        trigger: {
            here: here if there == "." else there for here, there in zip(states, row, strict=True)
        }
        for trigger, *row in rest
    }
