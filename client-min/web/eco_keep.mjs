// Answers of the server about a pack, kept by the browser until the next visit: the same answers, fed to
// a new client in the same order, make it hold what the last one held. A pack's id names its content, so
// nothing here is ever out of date. IndexedDB, as the Cache API is only for pages that come by TLS.

const NAME = 'ecostream', BYTES_MAX = 16 * 2 ** 20, PACKS_MAX = 4;

const done = (request) => new Promise((resolve, reject) => {
	request.onsuccess = () => resolve(request.result);
	request.onerror = () => reject(request.error);
});

const answersOf = (pack) => IDBKeyRange.bound([pack, 0], [pack, Infinity]);

function openDatabase() {
	const request = indexedDB.open(NAME, 1);
	request.onupgradeneeded = () => {
		request.result.createObjectStore('answers');    // [pack, number]: { bytes, whole, again }
		request.result.createObjectStore('packs');      // pack: when it was last opened
	};
	return done(request);
}

export class EcoKeep {
	/** Answers by a pack's id. Without a database, as in a private window, nothing is kept. */
	static async open(pack) {
		const keep = new EcoKeep();
		Object.assign(keep, { pack, database: null, count: 0, bytes: 0 });
		try {
			keep.database = await openDatabase();
			await keep.forgetOthers();
		} catch {
			keep.database = null;
		}
		return keep;
	}

	store(name, mode) {
		return this.database.transaction(name, mode).objectStore(name);
	}

	/** Marks this pack as used, and drops those that were not for the longest time. */
	async forgetOthers() {
		await done(this.store('packs', 'readwrite').put(Date.now(), this.pack));
		const packs = this.store('packs', 'readonly');
		const [names, times] = await Promise.all([done(packs.getAllKeys()), done(packs.getAll())]);
		const order = names.map((name, i) => [times[i], name]).sort(([a], [b]) => b - a);
		for (const [, name] of order.slice(PACKS_MAX)) {
			await done(this.store('answers', 'readwrite').delete(answersOf(name)));
			await done(this.store('packs', 'readwrite').delete(name));
		}
	}

	/** All answers in their order: { bytes, whole, again }. */
	async answers() {
		if (!this.database)
			return [];
		const answers = await done(this.store('answers', 'readonly').getAll(answersOf(this.pack)))
			.catch(() => []);
		this.count = answers.length;
		this.bytes = answers.reduce((sum, { bytes }) => sum + bytes.length, 0);
		return answers;
	}

	/** Keeps the next answer; `again`: it goes on with the request of the one before. An answer that is
	 * too much ends keeping, since those after it build upon it. */
	add(answer) {
		this.bytes += answer.bytes.length;
		if (!this.database || this.bytes > BYTES_MAX)
			return;
		const stop = () => { this.database = null; };
		try {
			const answers = this.store('answers', 'readwrite');
			done(answers.add(answer, [this.pack, this.count++])).catch(stop);
		} catch {
			stop();
		}
	}

	/** Forgets this pack's answers. */
	async clear() {
		[this.count, this.bytes] = [0, 0];
		if (!this.database)
			return;
		const answers = this.store('answers', 'readwrite');
		await done(answers.delete(answersOf(this.pack))).catch(() => {});
	}
}
