"""The chart compiled and stepped: SCXML in one pure step."""
