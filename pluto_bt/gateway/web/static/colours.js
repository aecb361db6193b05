// The colours of the map. One accent, for the robot and what it means to do; greys for the world; warm only where something is forbidden or wrong.

export const GROUND = "#0c0f13";
export const MINOR = "#141a21", MAJOR = "#1d252e";
export const WALL = "#8e9cab", SOLID = "#2a323c", LABEL = "#75828f";
export const ACCENT = "#5cc8ff", ACCENT_DIM = "rgba(92, 200, 255, 0.35)", ACCENT_FAINT = "rgba(92, 200, 255, 0.12)";
export const LASER = "#f2f5f8", SEEN = "rgba(242, 245, 248, 0.05)", ECHO = "rgba(242, 245, 248, 0.28)";
export const WARN = "#f0a63a", BAD = "#ff7b54", OLD = "#66727e";
export const AREAS = { named: "#75828f", map: "#8e9cab", forbidden: "#ff7b54", restrictive: "#f0a63a", "one-way": "#f0a63a", sector: "#75828f" };
export const CELLS = [[0, 0, 0, 0], [92, 200, 255, 14], [92, 200, 255, 46], [242, 245, 248, 70], [240, 166, 58, 150]]; // LocalMapState: not known, free, covered, stands, low
