#!/bin/sh
# record_flight.sh LON LAT RADIUS_M SECONDS: the subtitles that a drone would write on a round about a place: 30 records a second, five
# positions a second with six decimals, no position at first, one stray fix, the gimbal on the middle.
awk -v lon="$1" -v lat="$2" -v radius="$3" -v seconds="$4" '
function stamp(ms) { return sprintf("%02d:%02d:%02d,%03d", ms / 3600000, ms / 60000 % 60, ms / 1000 % 60, ms % 1000) }
BEGIN {
	pi = 3.14159265358979
	for (i = 0; i < seconds * 30; i++) {
		t = i / 30; at = int(t * 5) / 5; a = 2 * pi * at / seconds; now = 2 * pi * t / seconds
		x = lon + radius * cos(a) / (111320 * cos(lat * pi / 180)); y = lat + radius * sin(a) / 111195
		if (i == 150) x += 0.02
		if (i < 3) x = y = 0
		height = 14 + 6 * sin(2 * a); yaw = (630 - now * 180 / pi) % 360; if (yaw > 180) yaw -= 360
		printf "%d\n%s --> %s\n<font size=\"28\">FrameCnt: %d, DiffTime: 33ms\n", i + 1, stamp(int(t * 1000)), stamp(int((i + 1) * 1000 / 30)), i + 1
		printf "[iso: 100] [shutter: 1/800.0] [focal_len: 24.00] [dzoom_ratio: 1.00], [latitude: %.6f] [longitude: %.6f] ", y, x
		printf "[rel_alt: %.3f abs_alt: %.3f] [gb_yaw: %.1f gb_pitch: -12.0 gb_roll: 0.0] </font>\n\n", height, 520 + height, yaw
	}
}'
