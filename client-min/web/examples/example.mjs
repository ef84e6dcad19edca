// Shared by the example pages: which scene (?scene=http://HOST:PORT/v1/scenes/NAME), the module of its
// server, and a complaint where something fails. A page of your own needs the two lines of openLayer alone.

const given = new URLSearchParams(location.search).get('scene');

export function complain(error) {
	document.body.append(Object.assign(document.createElement('p'), { className: 'error',
		textContent: error.message }));
}

/** The layer of the page's scene. The module comes from the server that has the scene, which must know this page's
 * origin (ecoserve --cors). */
export async function openLayer(options) {
	if (!given)
		throw new Error('Say which scene: ?scene=http://127.0.0.1:8080/v1/scenes/NAME');
	const { origin, href } = new URL('../../viewer/eco_layer.mjs', given.replace(/\/+$/, ''));
	const { EcoLayer } = await import(href).catch((error) => {
		throw new Error(`${origin} does not answer, or not to this page: is it running, by ecoserve --cors `
			+ `${location.origin}? (${error.message})`);
	});
	const layer = new EcoLayer({ url: given, onError: complain, ...options });
	await layer.ready;
	return layer;
}

/** The eye of a scene's first view, metres: beside its middle, at `turn` radians from east, and from above. */
export function eyeBeside({ low, high }, turn) {
	const middle = low.map((v, i) => (v + high[i]) / 2), size = Math.hypot(high[0] - low[0], high[1] - low[1]);
	const eye = [middle[0] + Math.cos(turn) * size * 0.7, middle[1] + Math.sin(turn) * size * 0.7, high[2] + size * 0.2];
	return { eye, middle, size };
}

addEventListener('unhandledrejection', ({ reason }) => complain(reason));
// what a page's own module waits for and does not get is an error of the page
addEventListener('error', ({ error }) => error && complain(error));
