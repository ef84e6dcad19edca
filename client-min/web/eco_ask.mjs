// Requests for scenes go to ecoserve, or, for those of a published folder (ecopack publish), to its files and to a worker
// that plans in place of ecoserve (eco_published.mjs). The URL of a scene of ecoserve has /v1/scenes/ in it.

const page = globalThis.document?.getElementById('published');
/** The scenes of a published page, in their order: { about, first }, openapi.yaml's Scene and views that are answered; null: none. */
const published = page ? JSON.parse(page.textContent) : null;

/** The scenes of this page: openapi.yaml's Scenes. */
export async function scenesHere() {
	if (published)
		return published.map(({ about }) => about);
	const answer = await fetch('v1/scenes');
	if (!answer.ok)
		throw new Error(`v1/scenes: the server answered ${answer.status}`);
	return (await answer.json()).scenes;
}

/** The URL of a scene of this page. */
export const sceneUrl = (name) => new URL(`${published ? '' : 'v1/scenes/'}${encodeURIComponent(name)}`, location.href).href;

/** Whether rows of plants are known: a published scene has those of its columns alone. */
export const hasRows = (url, about) => url.includes('v1/scenes/') || Boolean(about.columns);

/** Says that a scene's pack is no longer asked for. */
export async function leave(url, pack) {
	if (!url.includes('v1/scenes/'))
		(await import('./eco_published.mjs')).leave(url, pack);
}

/** fetch(url + path, init), url: a scene's. */
export async function ask(url, path, init = {}) {
	if (url.includes('v1/scenes/'))
		return fetch(url + path, init);
	return (await import('./eco_published.mjs')).answer(url, path, init);
}
