// The viewer's words. The page and its scripts are written in English, and this table has them in German: its left
// side is English, {} stands for a value. A text that is not in the table is shown as it is,
// such as the names of a scene and reasons that the server says.

const german = {
	'Scene': 'Szene',
	'How the camera moves': 'Wie die Kamera sich bewegt',
	'Look': 'Ansehen',
	'Walk': 'Gehen',
	'Fly': 'Fliegen',
	'Sun': 'Sonne',
	'Layers': 'Ebenen',
	'Plants': 'Pflanzen',
	'Buildings and other objects': 'Gebäude und andere Objekte',
	'Ground': 'Boden',
	// classes of import/land/words/ground.tsv
	'sea': 'Meer', 'water': 'Wasser', 'paved': 'befestigt', 'bed': 'Beet', 'pitch': 'Sportplatz',
	'sand': 'Sand', 'rock': 'Fels', 'wood': 'Wald', 'scrub': 'Gebüsch', 'orchard': 'Obstgarten',
	'vineyard': 'Weinberg', 'wetland': 'Feuchtgebiet', 'grass': 'Gras', 'meadow': 'Wiese',
	'field': 'Feld', 'built up': 'bebaut', 'river': 'Fluss', 'stream': 'Bach', 'track': 'Feldweg',
	'path': 'Pfad', 'footway': 'Fußweg', 'service': 'Zufahrt', 'street': 'Straße',
	'main road': 'Hauptstraße', 'motorway': 'Autobahn', 'railway': 'Eisenbahn',
	// classes of import/places/words/tints.tsv
	'very good': 'sehr gut', 'good': 'gut', 'fair': 'mittel', 'poor': 'schlecht', 'critical': 'sehr schlecht', 'dead': 'tot',
	'new': 'neu', 'young': 'jung', 'semi-mature': 'halbwüchsig', 'mature': 'ausgewachsen', 'over-mature': 'überaltert',
	'veteran': 'uralt', 'kept': 'bleibt', 'felled': 'gefällt', 'moved': 'versetzt', 'pruned': 'geschnitten', 'other': 'andere',
	'not stated': 'nicht angegeben',
	'In view': 'Im Bild',
	'Find': 'Suchen',
	'Species, number of a row, or what a column says': 'Art, Nummer einer Zeile, oder was in einer Spalte steht',
	'Season': 'Jahreszeit',
	'spring': 'Frühling',
	'summer': 'Sommer',
	'autumn': 'Herbst',
	'winter': 'Winter',
	'Beside it, for before and after': 'Daneben, für vorher und nachher',
	'Nothing': 'Nichts',
	'Before and after': 'Vorher und nachher',
	'{} up to {} %, then {}': '{} bis {} %, dann {}',
	'{} is not at this place.': '{} liegt nicht an diesem Ort.',
	'guessed from trunk diameter': 'geschätzt aus dem Stammdurchmesser',
	'guessed from age': 'geschätzt aus dem Alter',
	'guessed from height': 'geschätzt aus der Höhe',
	'guessed from crown width': 'geschätzt aus der Kronenbreite',
	'guessed from the model': 'nach dem Modell geschätzt',
	'guessed from the scene file': 'nach der Szenendatei geschätzt',
	'a number from 0 to 1': 'eine Zahl von 0 bis 1',
	'Views': 'Ansichten',
	'Keep this view': 'Diese Ansicht merken',
	'Tour': 'Rundgang',
	'Camera script': 'Kameraskript',
	'More': 'Mehr',
	'Whole scene': 'Ganze Szene',
	'Measure': 'Messen',
	'Link': 'Link',
	'Picture': 'Bild',
	'Width in pixels': 'Breite in Pixeln',
	'Height in pixels': 'Höhe in Pixeln',
	'Save': 'Speichern',
	'With a caption': 'Mit Bildunterschrift',
	'Day of the sun': 'Tag des Sonnenstands',
	'The scene has no CRS, so its place on Earth is unknown.':
		'Die Szene hat kein Koordinatensystem; ihr Ort auf der Erde ist unbekannt.',
	'Details': 'Einzelheiten',
	'Vertices': 'Eckpunkte',
	'Bytes a view': 'Bytes je Ansicht',
	'Shadows': 'Schatten',
	'None': 'Keine',
	'Standard map': 'Gleichmäßige Karte',
	'Perspective map': 'Perspektivische Karte',
	'Colours by representation': 'Farben nach Darstellung',
	'Representations': 'Darstellungen',
	'Why this picture?': 'Warum dieses Bild?',
	'The vertices are spent on': 'Die Eckpunkte gehen an',
	'Plant by plant': 'Pflanze für Pflanze',
	'Keys and pointer': 'Tasten und Zeiger',
	['Drag or arrow keys turn; right button or two fingers move; wheel, pinch or + and - zoom. W A ' +
		'S D move, Q and E sink and rise. Click a plant, or I for the middle: what it is. H: the ' +
		'whole scene. C: colours. M: measure. P: picture. L: link. T: tour. F: full screen. Esc: ' +
		'closes.']:
		'Ziehen oder Pfeiltasten drehen; rechte Taste oder zwei Finger verschieben; Rad, Spreizen '
			+ 'oder + und - zoomen. W A S D bewegen, Q und E senken und heben. Klick auf eine Pflanze, oder '
			+ 'I für die Mitte: was es ist. H: ganze Szene. C: Farben. M: messen. P: Bild. L: Link. T: '
			+ 'Rundgang. F: ganzer Bildschirm. Esc: schließt.',
	'Full screen': 'Ganzer Bildschirm',
	'Draft': 'Entwurf',
	'Its plants are shown more coarsely. ecopack make without --draft makes the pack that is finer.':
		'Die Pflanzen sind gröber dargestellt. ecopack make ohne --draft macht das feinere Paket.',
	'Loading': 'Lädt',
	': this page needs JavaScript': ': diese Seite braucht JavaScript',
	['The scene. Arrow keys turn, W A S D move, Q E sink and rise, + and - zoom, I says what is in ' +
		'the middle']:
		'Die Szene. Pfeiltasten drehen, W A S D bewegen, Q E senken und heben, + und - zoomen, I '
			+ 'sagt, was in der Mitte ist',
	'Look at it': 'Ansehen',
	'Close': 'Schließen',
	'How it is drawn': 'Wie es gezeichnet ist',
	'North': 'Norden',
	'The y axis of the scene': 'Die y-Achse der Szene',
	'The link\'s sun is not used: the scene has no CRS, so its place on Earth is unknown.':
		'Die Sonne des Links gilt nicht: die Szene hat kein Koordinatensystem; ihr Ort auf der Erde ist unbekannt.',
	'The link\'s {}={} cannot be read: {} is expected.': '{}={} im Link ist nicht lesbar; erwartet wird: {}.',
	'The link has one of eye and target: both are needed.': 'Der Link hat nur eines von eye und target; beide sind nötig.',
	'The link\'s eye and target are one place.': 'eye und target des Links sind derselbe Ort.',
	'orbit, walk or fly': 'orbit, walk oder fly',
	'a whole number up to 16777216, 0 for as many as the device draws':
		'eine ganze Zahl bis 16777216, 0 für so viele, wie das Gerät schafft',
	'a whole number, -1 for no limit': 'eine ganze Zahl, -1 für keine Grenze',
	'0 or 1': '0 oder 1',
	'a time such as 2026-06-21T10:00Z': 'eine Zeit wie 2026-06-21T10:00Z',
	'none, standard or perspective': 'none, standard oder perspective',
	'some of plants, objects, ground': 'einige von plants, objects, ground',
	'NAME~X,Y,Z~X,Y,Z;... with eye and target': 'NAME~X,Y,Z~X,Y,Z;... mit eye und target',
	'X,Y,Z in metres': 'X,Y,Z in Metern',
	'The viewer could not be loaded; reload the page to try again.':
		'Der Betrachter konnte nicht geladen werden; bitte die Seite neu laden.',
	'This browser has no WebGL 2, which the viewer draws with.':
		'Dieser Browser hat kein WebGL 2, mit dem gezeichnet wird.',
	'The graphics driver has lost the picture; waiting for it':
		'Der Grafiktreiber hat das Bild verloren; es wird gewartet',
	'The server does not answer; trying again': 'Der Server antwortet nicht; neuer Versuch',
	'The server does not answer; reload the page to try again.':
		'Der Server antwortet nicht; bitte die Seite neu laden.',
	'This server has no scenes.': 'Dieser Server hat keine Szenen.',
	'This server has no scene {}; this is {}.': 'Dieser Server hat keine Szene {}; dies ist {}.',
	'Loading, {} bytes so far': 'Lädt, bisher {} Bytes',
	'row {} of {}': 'Zeile {} von {}',
	'{} away': '{} entfernt',
	'Plants found: {}': 'Gefundene Pflanzen: {}',
	'The first {} of more plants': 'Die ersten {} von mehr Pflanzen',
	'as fast as this device: {}': 'so viele wie dieses Gerät schafft: {}',
	'no limit': 'ohne Grenze',
	'The picture is saved once all of it is here': 'Das Bild wird gespeichert, sobald es ganz da ist',
	'; data of {}': '; Daten von {}',
	'; sun of {}, {}': '; Sonne am {}, {}',
	'Eye {}; target {}': 'Auge {}; Ziel {}',
	'Pack {}; {} vertices': 'Paket {}; {} Eckpunkte',
	'; expected agreement with full detail (Q) {}': '; erwartete Übereinstimmung mit voller Feinheit (Q) {}',
	'; measured error beside full detail ({} vertices): FLIP {}, m16 {}':
		'; gemessener Fehler gegen volle Feinheit ({} Eckpunkte): FLIP {}, m16 {}',
	'; measured error beside {} vertices: FLIP {}, m16 {}': '; gemessener Fehler gegen {} Eckpunkte: FLIP {}, m16 {}',
	'The picture is compared with one of all detail': 'Das Bild wird mit einem voller Feinheit verglichen',
	['FLIP is the error that people see where pictures alternate, 0 to 1; m16 the mean difference of colour ' +
		'(CIELAB) of blocks of 16 x 16 pixels. The view of the picture that was saved was drawn again, with more vertices ' +
		'and the same light; both are compared with 16 samples a pixel.']:
		'FLIP ist der Fehler, den man beim Wechsel zwischen zwei Bildern sieht, 0 bis 1; m16 der mittlere Farbunterschied '
			+ '(CIELAB) von Blöcken aus 16 x 16 Pixeln. Die Ansicht des gespeicherten Bilds wurde nochmals gezeichnet, mit mehr '
			+ 'Eckpunkten und gleichem Licht; verglichen werden beide mit 16 Abtastungen je Pixel.',
	'Link copied': 'Link kopiert',
	'The link is this page\'s address: {}': 'Der Link ist die Adresse dieser Seite: {}',
	'View {}': 'Ansicht {}',
	'Remove {}': '{} entfernen',
	'Click where to measure from': 'Den Anfang der Messung anklicken',
	'Click where to measure to': 'Das Ende der Messung anklicken',
	'{} apart; {} level, {} high': '{} Abstand; {} waagrecht, {} Höhe',
	'species not stated': 'Art nicht angegeben',
	'Species not stated': 'Art nicht angegeben',
	'{}, shown as {}': '{}, gezeigt als {}',
	' and {} more': ' und {} mehr',
	'and {} more': 'und {} mehr',
	' and {}': ' und {}',
	'Shown as {}: {}': 'Gezeigt als {}: {}',
	'own': 'eigene',
	'Plants in view': 'Pflanzen im Bild',
	'{}, more as points': '{}, weitere als Punkte',
	'Predicted Q': 'Vorhergesagtes Q',
	'Predicted m16': 'Vorhergesagtes m16',
	'Bytes so far': 'Bytes bisher',
	'Decoded': 'Entpackt',
	'Only points that stand for many plants': 'Nur Punkte, die für viele Pflanzen stehen',
	'A plant': 'Eine Pflanze',
	'A building or other object': 'Ein Gebäude oder anderes Objekt',
	'The sky': 'Der Himmel',
	'The ground': 'Der Boden',
	'Many plants as one point': 'Viele Pflanzen als ein Punkt',
	'Height': 'Höhe',
	'Width': 'Breite',
	'Crown width': 'Kronenbreite',
	'Of these': 'Von diesen',
	'Stands at': 'Steht bei',
	'Place': 'Ort',
	'Distance': 'Entfernung',
	'Shown as': 'Gezeigt als',
	'Class': 'Klasse',
	'Row': 'Zeile',
	'{} of {}': '{} von {}',
	' (line {})': ' (Zeile {} der Datei)',
	'Why: {}': 'Warum: {}',
	'Why: mostly, {}': 'Warum: meist, {}',
	'Why: in part, {}': 'Warum: zum Teil, {}',
	'{}, {} away, plants: {}': '{}, {} entfernt, Pflanzen: {}',
	'Plants of a part of the scene: {}': 'Pflanzen eines Teils der Szene: {}',
	'{} vertices': '{} Eckpunkte',
	'Each vertex puts {} pixels right, or more; none is drawn for less.':
		'Jeder Eckpunkt macht {} Pixel richtig oder mehr; für weniger wird keiner gezeichnet.',
	'There is room for all detail of this view.': 'Es ist Platz für alle Feinheiten dieser Ansicht.',
	'triangles': 'Dreiecke',
	'simpler triangles': 'einfachere Dreiecke',
	'lines': 'Linien',
	'points': 'Punkte',
	'blended triangles': 'gemischte Dreiecke',
	'blended simpler triangles': 'gemischte einfachere Dreiecke',
	'blended lines': 'gemischte Linien',
	'blended points': 'gemischte Punkte',
	'ellipsoids': 'Ellipsoide',
	'impostors': 'Kronenbilder',
	'summaries': 'Zusammenfassungen',
	'plants in full detail': 'Pflanzen in voller Feinheit',
	'detail; more would hardly be seen': 'Feinheiten; mehr sähe man kaum',
	'detail that ends where the vertices do': 'Feinheiten, so weit die Eckpunkte reichen',
	'detail that ends where the bytes do': 'Feinheiten, so weit die Bytes reichen',
	'more detail in some of many like plants': 'mehr Feinheiten in einigen von vielen gleichen Pflanzen',
	'a little more detail than needed, as some was left over':
		'etwas mehr Feinheiten als nötig, da etwas übrig war',
	'plants drawn as a whole, as single leaves would not be seen':
		'ganze Pflanzen, da man einzelne Blätter nicht sähe',
	'points that stand for many plants': 'Punkte, die für viele Pflanzen stehen',
	'points that stand for many plants, far away': 'ferne Punkte, die für viele Pflanzen stehen',
	'points that stand for many plants, between single ones':
		'Punkte, die für viele Pflanzen stehen, zwischen einzelnen',
	'what the rule of Deussen asks for': 'was Deussens Regel verlangt',
	'Forward': 'Vorwärts',
	'Back': 'Zurück',
	'To the left': 'Nach links',
	'To the right': 'Nach rechts',
};

export const language = navigator.language?.startsWith('de') ? 'de' : 'en';

/** A text in the reader's language, with values in turn for each {}. */
export function t(text, ...values) {
	return ((language === 'de' && german[text]) || text).replaceAll('{}', () => values.shift());
}

/** A number with so many digits behind the point. */
export const fixed = (n, digits) => n.toLocaleString(language,
	{ minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false });

/** All texts of the page itself. */
export function translatePage() {
	document.documentElement.lang = language;
	const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), nodes = [];
	while (walk.nextNode())
		nodes.push(walk.currentNode);
	for (const node of nodes) {
		const text = node.data.replace(/\s+/g, ' ').trim();
		node.data = text ? node.data.replace(node.data.trim(), () => t(text)) : node.data;
	}
	for (const name of ['aria-label', 'title', 'placeholder'])
		for (const element of document.querySelectorAll(`[${name}]`))
			element.setAttribute(name, t(element.getAttribute(name).replace(/\s+/g, ' ')));
}
