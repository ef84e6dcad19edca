// Which row of which inventory a plant comes from. Packs do not keep it; `ecopack map scene.json -o
// plants.geojson` does: a point a plant, WGS 84, with species, height_m, file and row.

const DEGREE_M = 6371008.8 * Math.PI / 180;
// a projection's metres differ from the ground's by up to so much, and files have centimetres
const STRETCH = 0.005, EXACT_M = 0.05, HEIGHT_EXACT = 0.01;

/** Metres east and north of the scene's origin. */
function groundOf([x, y], { convergence_deg: convergence }) {
	const turn = convergence * Math.PI / 180;
	return [x * Math.cos(turn) + y * Math.sin(turn), y * Math.cos(turn) - x * Math.sin(turn)];
}

/** Rows of a file's text, near to each other in the scene whose origin is given. Throws what is wrong. */
export function readRows(text, origin) {
	if (origin?.longitude_deg === undefined)
		throw new Error('This scene does not say where on Earth it is, so that rows cannot be found in it.');
	const { features } = JSON.parse(text);
	if (!Array.isArray(features))
		throw new Error('This is no GeoJSON of plants; ecopack map scene.json -o plants.geojson makes one.');
	const shrink = Math.cos(origin.latitude_deg * Math.PI / 180) * DEGREE_M;
	return features.filter(({ geometry }) => geometry?.type === 'Point').map(({ geometry, properties }) => ({
		...properties,
		at: [(geometry.coordinates[0] - origin.longitude_deg) * shrink,
			(geometry.coordinates[1] - origin.latitude_deg) * DEGREE_M],
	}));
}

/** The row of a plant that was picked (web_pick.h): of those as high, or of no known height, the nearest; null: none
 * is here. */
export function rowOf(rows, { foot, height_m: height }, origin) {
	const [east, north] = groundOf(foot, origin);
	const reach = EXACT_M + STRETCH * Math.hypot(east, north);
	const apart = ({ at }) => Math.hypot(at[0] - east, at[1] - north);
	const isAsHigh = ({ height_m: own }) => own == null || Math.abs(own / height - 1) <= HEIGHT_EXACT;
	return rows.filter((row) => apart(row) < reach && isAsHigh(row))
		.reduce((a, b) => a && apart(a) <= apart(b) ? a : b, null);
}
