"""A mission that keeps its gimbal on a beacon while it flies past."""

GIMBAL_WATCH = """\
missionkit: 1
mission: gimbal-watch
world: worlds/meadow.yaml
camera:
  {use: corners, width: 1280, height: 960, focal: 800, rate: 10, gimbal: {yaw_deg: [-160, 160]}}
targets:
  beacon: {position: [19, 35, 0], position_sd: 4.0}
perception: [{use: aruco, target: beacon, id: 5, size: 0.80, upright: false}]
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.25}, unknown: take, to: land}
  - {name: camera, when: {use: camera_silent, frames: 30}, unknown: ignore, to: land}
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 10}, transitions: [{to: aim, when: done}]}
  aim: {kind: gps, behavior: {use: gimbal, target: beacon}, transitions: [{to: past, when: done}]}
  past:
    kind: gps
    behavior: {use: waypoints, places: [[5, 30, -10], [35, 30, -10]], speed: 5}
    transitions: [{to: level, when: done}]
  level: {kind: gps, behavior: {use: gimbal, pitch_deg: -90}, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""
