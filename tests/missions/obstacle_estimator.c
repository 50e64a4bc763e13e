// Tracks obstacles: each position is a running mean of what was measured.
//
// input vehicle.position.{x,y,z} m
// input detections.seen[1..4] Boolean
// input detections.distance[1..4] m
// input detections.bearing[1..4] rad
// input detections.height[1..4] m
// input detections.radius[1..4] m
// output tracks.seen[1..4] Boolean
// output tracks.position[1..4].{x,y,z} m
// output tracks.radius[1..4] m

static void begin(struct unit *unit) {}

static void advance(struct unit *unit) {
    for (int i = 0; i < 4; i++) {
        double away = R[detections_distance + i], bearing = R[detections_bearing + i];
        double measured[] = {away * cos(bearing), away * sin(bearing), R[detections_height + i]};
        double weight = B[tracks_seen + i] ? 0.5 : 1;
        for (int k = 0; k < 3; k++) {
            double *track = &R[tracks_position + 3 * i + k];
            *track += weight * (R[vehicle_position + k] + measured[k] - *track);
        }
        B[tracks_seen + i] = B[detections_seen + i];
        R[tracks_radius + i] = R[detections_radius + i];
    }
}
