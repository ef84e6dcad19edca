#!/bin/sh
# ecopack start, as a stranger meets it: inventories of other shape, unit, language and CRS, each to the right scene or to a question that
# names the choice; and what `make` says of scenes that can hardly be meant. BUILD is the folder of the programs.
set -u
BUILD=${BUILD:-build}
PACK=$BUILD/ecopack
DIR=$BUILD/tmp/start-sh-$$
failed=0
mkdir -p "$DIR/models/sub"
export XDG_CACHE_HOME="$PWD/$DIR/xdg"
trap 'rm -rf "$DIR"' EXIT

complain() { echo "test_start: $*"; failed=1; }

# model NAME HEIGHT: a stem and a crown
model() {
	awk -v h="$2" 'BEGIN { printf "# Units: m\nv -0.1 0 0\nv 0.1 0 0\nv 0 %g 0.1\nv %g %g 0\nv %g %g 0.3\nv 0 %g %g\nf 1 2 3\nf 4 5 6\nf 3 4 6\n",
		h / 2, -h / 4, h / 2, h / 4, h / 2, h, h / 8 }' >"$DIR/models/$1.obj"
}
model stieleiche 14; model sub/linden_1 12; model linden_2 11; model norway_spruce 20; model holly_bush 2; model rock 3; model maple_dead 9

# start STATUS PATTERN TABLE OPTION... : into $DIR/my
start() {
	wanted=$1 pattern=$2 table=$3; shift 3
	rm -rf "$DIR/my"
	"$PACK" start "$DIR/$table" "$DIR/models" -o "$DIR/my/" "$@" >"$DIR/out" 2>&1 </dev/null
	status=$?
	[ $status -eq "$wanted" ] || complain "$table $*: status $status instead of $wanted: $(tail -c 600 "$DIR/out")"
	tr -s '\n ' ' ' <"$DIR/out" | grep -Eq -- "$pattern" || complain "$table $*: says nothing like /$pattern/: $(cat "$DIR/out")"
	[ "$wanted" -eq 0 ] || [ ! -e "$DIR/my" ] || complain "$table $*: left $(ls "$DIR/my")"
}
# is FILTER VALUE: of the scene that was written
is() {
	got=$(jq -c "$1" "$DIR/my/scene.json" 2>&1)
	[ "$got" = "$2" ] || complain "$table: $1 is $got instead of $2"
}
# camera X Y: where the middle of the plants is, and an eye above it
camera() {
	jq -e --argjson x "$1" --argjson y "$2" '.keyframes[0] | (.target[0] - $x | fabs) < 60 and (.target[1] - $y | fabs) < 60 and .eye[2] > 3 and .eye[1] < .target[1]' \
		"$DIR/my/camera.json" >/dev/null || complain "$table: camera $(jq -c .keyframes[0] "$DIR/my/camera.json")"
}

# ---- German: semicolons, decimal commas, a byte order mark, a CRS in the columns' names, girths in centimetres ----
awk 'BEGIN { printf "\357\273\277Baum-Nr;Baumart (botanisch);H\303\266he (m);Stammumfang [cm];Ostwert_25832;Nordwert_25832\r\n"
	for (i = 0; i < 60; i++) printf "%d;%s;%d,5;%d;6916%02d,25;53347%02d,5\r\n", i, i % 3 ? "Quercus robur" : "Tilia cordata", 6 + i % 15, 40 + 3 * i, i, i }' >"$DIR/de.csv"
start 0 'decimal commas' de.csv
is '[.crs, .origin]' '["EPSG:25832",[691630,5334730]]'
is '.instances[0] | [.x, .y, .crs, .decimal, .species]' '["Ostwert_25832","Nordwert_25832","EPSG:25832",",","Baumart (botanisch)"]'
is '.instances[0].height_m' '[{"column":"Höhe (m)","unit":"m"},{"by":"species","from_girth":"Stammumfang [cm]","unit":"cm","spread":0.15},13.5]'
is '.instances[0].map' '{"Quercus robur":"stieleiche","Tilia cordata":"linden","*":"stieleiche"}'
is '.instances[0].grown' '"stand"'
is '.plants.linden.variants | length' 2
camera 0 0
file "$DIR/my/map.png" 2>/dev/null | grep -q PNG || [ "$(head -c 4 "$DIR/my/map.png" | tail -c 3)" = PNG ] || complain "map.png is none"

# ---- colours by a column: noted, and taken where they are asked for; then felled trees are there ----
awk 'BEGIN { print "species,x_m,y_m,height_m,Zustand,Massnahme,Jahr"; for (i = 0; i < 40; i++)
	printf "oak,%d,%d,12,%s,%s,%d\n", i % 8 * 5, i * 3, i % 3 ? "gut" : "sehr schlecht (Stamm)", i % 5 ? "Erhalt" : "gef\303\244llt", 1941 + 2 * i }' >"$DIR/tint.csv"
start 0 'tint none .*"Zustand" .health., "Massnahme" .status.* change: --tint COLUMN' tint.csv
is '.instances[0].tint' null
start 0 'tint "Massnahme" in the colours of "status"' tint.csv --tint Massnahme
is '.instances[0].tint' '{"column":"Massnahme","palette":"status"}'
"$PACK" map "$DIR/my/scene.json" -o "$DIR/tint.png" >"$DIR/out" 2>&1 && grep -q 'felled  *8$' "$DIR/out" || complain "tint: $(cat "$DIR/out")"
start 0 'tint "Jahr" in the colours of "age"' tint.csv --tint Jahr
is '.instances[0].tint.breaks' '[1957,1973,1987,2003]'
start 1 'has no such column' tint.csv --tint Zustaende

# ---- one habit of the library for all: a shrub is as high as shrubs are ----
awk 'BEGIN { print "x_m,y_m,dbh_cm"; for (i = 0; i < 40; i++) printf "%d,%d,%d\n", i % 8 * 5, i * 3, i + 5 }' >"$DIR/shrub.csv"
start 0 'without a size 2 m .usual for a shrub' shrub.csv --plant 'round shrub'

# ---- thousands: commas that other rows or other columns explain, or the user; spaces ----
printf 'species,Easting_32632,Northing_32632,h_m\noak,"691,234","5,334,000",12\noak,"691,260.5","5,334,020",9\n' >"$DIR/thousands.csv"
start 0 'commas between thousands .as they part groups of three digits everywhere.' thousands.csv
is '[.crs, .origin, .instances[0].thousands, .instances[0].decimal]' '["EPSG:32632",[691260,5334020],",",null]'
"$PACK" map "$DIR/my/scene.json" -o "$DIR/map.png" >"$DIR/out" 2>&1 && grep -q '2 plants' "$DIR/out" || complain "thousands: $(cat "$DIR/out")"
printf 'species;x;y\noak;691,234;334,000\noak;691,260;334,020\n' >"$DIR/open.csv"
start 1 'do the commas in "x" and "y" part thousands or decimals.*--decimal \. if they part thousands, else --decimal ,' open.csv
start 0 'commas between thousands .as you say.' open.csv --decimal . --crs EPSG:2056
start 0 'metres of a plot: from 691' open.csv --decimal ,
printf 'species;Ostwert_25832;Nordwert_25832\nEiche;691 234,5;5\302\240334\302\240000\nEiche;691 260;5\342\200\257334\342\200\257020\n' >"$DIR/spaces.csv"
start 0 'decimal commas' spaces.csv
is '[.crs, .origin]' '["EPSG:25832",[691260,5334020]]'

# ---- units in the names of coordinates: a plot in centimetres or feet, a grid in feet ----
awk 'BEGIN { print "species,x_cm,y_cm"; for (i = 0; i < 60; i++) print "oak," i * 97 % 5000 "," 100000 + i * 411 % 8000 }' >"$DIR/cm.csv"
start 0 'x is "x_cm", y is "y_cm", in cm.*cm of a plot: from 44, 100029 .*within 49.5 x 78.4 m' cm.csv
is '[.origin, .instances[0].unit]' '[[20,1040],"cm"]'
awk 'BEGIN { print "species,X (ft),Y (ft)"; for (i = 0; i < 60; i++) print "oak," 984000 + i * 97 % 500 ".5," 194000 + i * 411 % 800 ".25" }' >"$DIR/ft.csv"
start 1 'may be in .*EPSG:2263 .NAD83 / New York Long Island .ftUS' ft.csv
! grep -q UTM "$DIR/out" || complain "ft.csv: a grid of metres is offered: $(cat "$DIR/out")"

# ---- azimuth and distance: of one plot, of several without and with their centres; a tree's own place counts more ----
awk 'BEGIN { print "plot,species,azi,hdist_m"; for (i = 0; i < 60; i++) printf "1,oak,%d,%.1f\n", i * 37 % 400, i * 97 % 120 / 10 }' >"$DIR/polar.csv"
start 0 'azimuth "azi" in gon, distance "hdist_m" in m .no column says a place' polar.csv
is '[.origin, .instances[0].polar, .instances[0].x]' '[[0,0],{"azimuth":"azi","distance":"hdist_m","unit":"m","whole_turn":400},null]'
sed 's/^1,\(oak,[0-9]*[05],\)/2,\1/' "$DIR/polar.csv" >"$DIR/plots.csv"
start 1 'centres of several plots .*"plot" is "2" and "1".*add columns with easting and northing, or longitude and latitude' plots.csv
awk -F, 'BEGIN { OFS = "," } { print $0, (NR > 1 ? 11.5 + $1 / 100 "," 48.1 : "lon,lat") }' "$DIR/plots.csv" >"$DIR/centres.csv"
start 0 'several rows share each place, which so is a plot.s centre' centres.csv
is '[.crs, .instances[0].x, .instances[0].polar.distance]' '["EPSG:32632","lon","hdist_m"]'
awk -F, 'BEGIN { OFS = "," } { print $0, (NR > 1 ? 11.5 + NR / 10000 "," 48.1 : "lon,lat") }' "$DIR/plots.csv" >"$DIR/own.csv"
start 0 'x is "lon"' own.csv
is '.instances[0].polar' null

# ---- places within quadrats ----
awk 'BEGIN { print "quadrat,lx,ly,sp"; for (i = 0; i < 400; i++) printf "%02d%02d,%.1f,%.1f,oak\n", i % 7, i % 11, i * 97 % 200 / 10, i * 411 % 200 / 10 }' >"$DIR/quadrats.csv"
echo '0000,20.4,3,oak' >>"$DIR/quadrats.csv"
start 0 'within quadrats of 20 m, "quadrat".*within 140 x 220 m' quadrats.csv
is '.instances[0].quadrat' '{"column":"quadrat","size_m":20}'
cut -d, -f2- "$DIR/quadrats.csv" >"$DIR/local.csv"
start 1 '"lx" and "ly" count from the corner of a quadrat, and no column says which: add columns with x and y' local.csv

awk 'BEGIN { print "sp,square.x,square.y,d.x,d.y"; for (i = 0; i < 400; i++) print "oak," i % 5 "," int(i / 5) % 5 "," i * 37 % 101 / 10 "," i * 11 % 101 / 10 }' >"$DIR/heaps.csv"
start 1 '"square.x" and "square.y" are places of plots, or numbers of quadrats, not of plants: 8 rows or more share each' heaps.csv
start 0 'within 4 x 4 m' heaps.csv --x square.x --y square.y

# ---- a file whose coordinates are texts ----
echo '{"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"Point","coordinates":["11.5","48.1"]},"properties":{"species":"oak"}}]}' >"$DIR/quoted.geojson"
start 1 'no row is a point; .*coordinates in quotes are none' quoted.geojson

# ---- a species in capitals and without is one key ----
printf 'species,lon,lat\nQuercus robur,11.5,48.1\nQuercus robur,11.501,48.1\nquercus robur,11.502,48.1\n' >"$DIR/capitals.csv"
start 0 '3 rows, 3 plants' capitals.csv
is '.instances[0].map | keys' '["*","Quercus robur"]'

# ---- a column of zones ----
printf 'species,easting,northing,utm_zone\noak,323400,4307500,18N\noak,323420,4307520,18N\n' >"$DIR/zone.csv"
start 0 'WGS 84 / UTM zone 18N, as "utm_zone" says, "18N"; a place at -77' zone.csv
is '[.crs, .instances[0].crs]' '["EPSG:32618","EPSG:32618"]'
printf 'oak,723400,4307500,17N\n' >>"$DIR/zone.csv"
start 1 'rows are in several zones: "utm_zone" is "18N" and "17N".*"only": ."utm_zone": "18N"' zone.csv

start 0 'UTM zone 18N, as you say; a place at .*; but "utm_zone" is "18N" and "17N": give the entry "only": ."utm_zone": ...' zone.csv --crs EPSG:32618
printf 'species,easting,northing,utm_zone\noak,323400,4307500,18N\noak,323420,4307520,18N\n' >"$DIR/zone.csv"
start 0 'as you say; a place at -83.*; but "utm_zone" says "18N", EPSG:32618, a place at -77' zone.csv --crs EPSG:32617
start 0 'NAD83 / UTM zone 18N, as you say' zone.csv --crs EPSG:26918
! grep -q 'but "utm_zone"' "$DIR/out" || complain "zone.csv: a datum alone is doubted: $(cat "$DIR/out")"
awk 'BEGIN { print "species,easting,northing,utm_zone"; for (i = 0; i < 5000; i++) print "oak," 323400 + i % 70 "," 4307500 + i % 50 "," (i == 4001 ? "17N" : "18N") }' >"$DIR/zone.csv"
start 1 'rows are in several zones: "utm_zone" is "18N" and "17N"' zone.csv

# ---- Crown bases and live crown ratios choose between variants ----
printf 'species,x,y,height_m,crown base (m)\noak,0,0,12,4\noak,20,10,14,5\n' >"$DIR/base.csv"
start 0 'crown base "crown base .m." in m' base.csv
is '.instances[0] | [.crown_base.column, .crown_base.is, .crown_base.unit, .crown_m.column]' '["crown base (m)","height","m",null]'
printf 'species,x,y,height_m,LCR,crown_diameter_m\noak,0,0,12,40,5\noak,20,10,14,55,6\n' >"$DIR/ratio.csv"
start 0 'crown base "LCR", a ratio' ratio.csv
is '.instances[0] | [.crown_base.column, .crown_base.is, .crown_m.column]' '["LCR","ratio","crown_diameter_m"]'

# ---- French: tabs, a national grid by its short name ----
awk 'BEGIN { print "essence\thauteur_m\tcirconf\303\251rence\tX_L93\tY_L93"
	for (i = 0; i < 40; i++) printf "%s\t%d\t%d\t%d\t%d\n", i % 2 ? "\303\211pic\303\251a commun" : "Houx", 5 + i % 18, 30 + 4 * i, 652000 + 10 * i, 6862000 + i }' >"$DIR/fr.tsv"
start 0 'Lambert-93, by the columns. names' fr.tsv
is '[.crs, .instances[0].x]' '["EPSG:2154","X_L93"]'
is '.instances[0].map | [."Houx", ."Épicéa commun"]' '["holly_bush","norway_spruce"]'
is '.instances[0].height_m[1] | [.from_girth, .unit]' '["circonférence","cm"]'
is '.instances[0].grown' null
is '.instances[0].height_m[1].per_plant' '{"holly_bush":{"max":12,"rate":0.002}}'
camera 0 0

# ---- A portal's export: latitude and longitude in one field; no model has the form of cypress and willow ----
awk 'BEGIN { print "IDBASE;ESPECE;CIRCONFERENCE (cm);geo_point_2d"
	split("Cupressus sempervirens|Salix alba|Tilia cordata", species, "|")
	for (i = 0; i < 45; i++) printf "%d;%s;%d;48.8%04d, 2.36%03d\n", i, species[1 + i % 3], 40 + 3 * i, 3000 + 7 * i, 9 * i }' >"$DIR/portal.csv"
start 0 'latitude and longitude in one field' portal.csv
is '[.crs, (.instances[0] | has("x")), .instances[0].height_m[0].from_girth]' '["EPSG:32631",false,"CIRCONFERENCE (cm)"]'
is '.instances[0].map | [."Cupressus sempervirens", ."Tilia cordata"]' '["cupressus cypress","linden"]'
is '.instances[0].map."Salix alba" | . == "stieleiche" or . == "linden"' true

# ---- English: degrees, feet and inches that no name says, vacant places, a misspelling ----
awk 'BEGIN { print "Site,Species,Diameter,Height,Latitude,Longitude"
	for (i = 0; i < 200; i++) printf "%d,%s,%d,%d,%.6f,%.6f\n", i, i % 5 == 0 ? "Vacant site" : i % 5 == 1 ? "\"maple, Norway (Acer platanoides)\"" : i % 5 == 2 ? "Qercus rubra" : "\"oak, pin (Quercus palustris)\"",
		i % 5 ? 4 + i % 27 : 0, i % 5 ? 15 + i % 50 : 0, 45.52 + i / 50000, -122.67 + i / 40000 }' >"$DIR/us.csv"
start 0 'Qercus rubra. is meant as quercus' us.csv
is '[.crs, .instances[0].crs, .instances[0].x, .instances[0].y]' '["EPSG:32610","EPSG:4326","Longitude","Latitude"]'
is '.instances[0].height_m[0:2] | [.[0].unit, .[1].unit]' '["ft","in"]'
is '.instances[0].map | [."Vacant site", ."Qercus rubra", ."oak, pin (Quercus palustris)"]' '[null,"stieleiche","stieleiche"]'
is '.plants | has("maple_dead")' false
is '.plants | has("rock")' false
camera 0 0

# ---- Villages along a river: the first look is not at the water between them, in which one willow stands ----
awk 'BEGIN { print "species,x,y"
	for (i = 0; i < 120; i++) printf "oak,%d,%d\n", (i % 2 ? -2000 : 2000) + i % 11 * 9, int(i / 11) * 9; print "oak,0,0" }' >"$DIR/river.csv"
start 0 '121 plants' river.csv
jq -es '.[0].origin[0] + .[1].keyframes[0].target[0] | fabs > 1900' "$DIR/my/scene.json" "$DIR/my/camera.json" >/dev/null || complain "river: $(cat "$DIR/my/camera.json")"

# ---- The same with latitude and longitude in each other's columns ----
awk -F, 'BEGIN { OFS = "," } NR > 1 { t = $(NF - 1); $(NF - 1) = $NF; $NF = t } { print }' "$DIR/us.csv" >"$DIR/swapped.csv"
start 0 'are swapped: a latitude lies between -90 and 90' swapped.csv
is '[.crs, .instances[0].x, .instances[0].y]' '["EPSG:32610","Latitude","Longitude"]'

# ---- The same where both may be latitudes: no tree stands at 77 degrees south ----
awk -F, 'BEGIN { OFS = "," } NR > 1 { $(NF - 1) = -77.03 + NR / 50000; $NF = 38.9 + NR / 50000 } { print }' "$DIR/us.csv" >"$DIR/polar.csv"
start 0 'are swapped: no tree stands at latitude -77' polar.csv
is '[.crs, .instances[0].x]' '["EPSG:32618","Latitude"]'

# ---- Degrees with a CRS in metres or feet: they would be one spot ----
deg() { awk -v first="$1" -v x="$2" -v y="$3" 'BEGIN { print first; for (i = 0; i < 1200; i++) printf "oak,%d,%.5f,%.5f\n", 5 + i % 9, x + i % 40 / 2000, y + int(i / 40) / 2000 }'; }
deg species,height,lon,lat 8.6 50.1 >"$DIR/degrees.csv"
deg species,height,x,y 8.6 50.1 >"$DIR/degrees_xy.csv"
for crs in EPSG:25832 EPSG:3857 EPSG:2056 EPSG:2263; do
	for file in degrees degrees_xy; do
		start 1 "look like degrees, but $crs counts in metres or feet: all plants would stand on one spot.* --crs EPSG:4326" $file.csv --crs $crs
	done
done
start 0 'within 1.4 x 1.62 km' degrees.csv --crs EPSG:4326 --scene-crs EPSG:25832

# ---- Longitude and latitude swapped where both stay valid: the areas of CRSs and terrain tell, a stated CRS or not ----
deg species,height,lon,lat 50.1 8.6 >"$DIR/turned.csv"
start 0 'are swapped: with this choice alone they lie in the area of use of ETRS89, longitude -16.1 to 40.18' turned.csv --crs EPSG:4258
is '[.crs, .instances[0].x, .instances[0].crs]' '["EPSG:32632","lat","EPSG:4258"]'
start 0 'are swapped: with this choice alone they lie in the area of use of ETRS89 / UTM zone 32N' turned.csv --crs EPSG:4326 --scene-crs EPSG:25832
start 0 'WGS 84, as you say; a place at 50.110, 8.608' turned.csv --crs EPSG:4326
start 0 'as you say; a place at .*; but its area of use is longitude 167.7 to -40.73' degrees.csv --crs EPSG:4269
deg species,height,x,y 5580000 470000 | sed '1!s/\.00000//g' >"$DIR/turned_utm.csv"
start 0 'are swapped: with this choice alone they lie in the CRS.s area of use, longitude 6 to 12.01' turned_utm.csv --crs EPSG:25832
echo '{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::4258"}},"features":[{"type":"Feature","properties":{"species":"oak"},"geometry":{"type":"Point","coordinates":[50.1,8.6]}}]}' >"$DIR/turned.geojson"
start 1 'x and y of its points are swapped, as 50.1, 8.6: with this choice alone they lie in the area of use of ETRS89' turned.geojson

# ---- Degrees, minutes and seconds ----
awk 'BEGIN { print "especie;altura;latitud;longitud"
	for (i = 0; i < 40; i++) printf "roble;%d;40\302\26024'"'"'%05.2f\" N;3\302\26041'"'"'%05.2f\" W\n", 4 + i % 17, i, i }' >"$DIR/minutes.csv"
start 0 'around -3.68.., 40.40' minutes.csv
is .crs '"EPSG:32630"'
"$PACK" map "$DIR/my/scene.json" -o "$DIR/my/plants.geojson" -q >"$DIR/out" 2>&1 && [ "$(jq '.features | length' "$DIR/my/plants.geojson")" = 40 ] ||
	complain "minutes: $(cat "$DIR/out")"

# ---- Grids that several countries' numbers fit: no candidate is cut, and the rest is counted ----
gk() { awk -v first="$1" -v x="$2" -v y="$3" 'BEGIN { print first; for (i = 0; i < 50; i++) printf "Linde;%d;%d;%d\n", 5 + i % 9, x + 3 * i, y + 2 * i }'; }
gk 'Baumart;Baumhöhe;Rechtswert;Hochwert' 3567123 5802345 >"$DIR/gk.csv"
start 1 '5802.* may be in EPSG:31467 .DHDN / 3-degree Gauss-Kruger zone 3; at 9\.99, 52\.35., EPSG:5345 ' gk.csv
grep -Eq '(EPSG:[0-9]+ \([^;]*; at [-0-9.]+, [-0-9.]+\)(, | and [0-9]+ more)?)+; give it with --crs EPSG:\.\.\.$' "$DIR/out" || complain "gk: a candidate is cut: $(cat "$DIR/out")"
gk 'Species;Height;Easting;Northing' 532100 181200 >"$DIR/gb.csv"
start 1 "or the country's grid, EPSG:27700 .OSGB36 / British National Grid; at -0.09, 51.51" gb.csv
grep -Eq 'EPSG:[0-9]+ \([^;]*; at [-0-9.]+, [-0-9.]+\)( and [0-9]+ more)?$' "$DIR/out" || complain "gb: a candidate is cut: $(cat "$DIR/out")"
gk 'Especie;Altura;coord_x;coord_y' 440512 4474010 >"$DIR/utm.csv"
start 0 'as you say; a place at -3.70' utm.csv --crs EPSG:25830
is .crs '"EPSG:25830"'

# ---- Surveyors' x, which counts to the north: asked about, unless the axes are said ----
gk 'Gatunek;Wysokość;X (PUWG 1992);Y (PUWG 1992)' 486567 637273 >"$DIR/pl.csv"
start 1 'as x does in EPSG:2180 .*To the east .* at 18.79.*to the north at 21.01' pl.csv
start 0 'a place at 21.01' pl.csv --x 'Y (PUWG 1992)' --y 'X (PUWG 1992)'

# ---- Titles before the names; species of no known form ----
{ printf 'Trees of a town\n2024\n\n'; awk 'BEGIN { print "species,height_m,lon,lat"; for (i = 0; i < 40; i++) printf "%s,%d,%.4f,48.1\n", i % 2 ? "oak" : "zzyzx", 5 + i % 9, 11.5 + i / 5000 }'; } >"$DIR/titles.csv"
start 0 'before line 4 are no table.*their form is not known: zzyzx' titles.csv
is '.instances[0].map.oak' '"stieleiche"'

# ---- A model that cannot be read: what to do ----
mkdir "$DIR/broken" && cp "$DIR/models/linden_2.obj" "$DIR/broken" && echo 'Kaydara FBX Binary  ' >"$DIR/broken/oak.fbx"
"$PACK" start "$DIR/titles.csv" "$DIR/broken" -o "$DIR/mine" >"$DIR/out" 2>&1 && complain "broken: it reads $(cat "$DIR/out")"
tr -s '\n ' ' ' <"$DIR/out" | grep -q 'oak.fbx: .*; or move it out of .*broken: another model' || complain "broken: $(cat "$DIR/out")"

# ---- Spanish: heights in centimetres, degrees of the south with decimal commas ----
awk 'BEGIN { print "especie;altura;longitud;latitud"
	for (i = 0; i < 50; i++) { s = sprintf("%s;%d;%.5f;%.5f", i % 2 ? "roble" : "tilo", 500 + 30 * i, -70.65 + i / 10000, -33.44 - i / 10000); gsub(/\./, ",", s); print s } }' >"$DIR/es.csv"
start 0 'altura. in cm' es.csv
is '[.crs, .instances[0].decimal, .instances[0].height_m[0].unit]' '["EPSG:32719",",","cm"]'
is '.instances[0].map | [.roble, .tilo]' '["stieleiche","linden"]'

# ---- A plot: metres from its corner, no CRS ----
awk 'BEGIN { print "tag,sp,species,gx,gy,dbh_mm"; for (i = 0; i < 90; i++) printf "%d,x,%s,%.1f,%.1f,%d\n", i, i % 2 ? "Picea abies" : "Ilex aquifolium", i % 10 * 9.3, i * 1.1, 10 + i * 5 }' >"$DIR/plot.csv"
start 0 'metres of a plot' plot.csv
is '[has("crs"), .instances[0].x, .instances[0].height_m[0].unit]' '[false,"gx","mm"]'
camera 0 0

# ---- GeoJSON of points ----
awk 'BEGIN { printf "{\"type\": \"FeatureCollection\", \"features\": ["
	for (i = 0; i < 20; i++) printf "%s{\"type\": \"Feature\", \"geometry\": {\"type\": \"Point\", \"coordinates\": [%f, %f]}, \"properties\": {\"boomsoort\": \"zomereik\", \"hoogte\": \"%d m\"}}", i ? "," : "", 4.9 + i / 5000, 52.37, 8 + i % 9
	print "]}" }' >"$DIR/nl.geojson"
start 0 "the file.s points" nl.geojson
is '[.crs, (.instances[0] | has("x")), (.instances[0].map | .zomereik)]' '["EPSG:32631",false,"stieleiche"]'

# ---- An epithet that is nearly one of its genus ----
awk 'BEGIN { print "species,lon,lat"; for (i = 0; i < 61; i++) printf "%s,%f,48.1\n", i == 60 ? "Picea abeis" : "Picea abies", 11.5 + i / 5000 }' >"$DIR/near.csv"
start 0 '"Picea abeis" is meant as abies.*first in line 62' near.csv
is '.instances[0] | has("height_m")' false

# ---- Columns that say a species in a few rows only are left aside ----
awk 'BEGIN { print "botanical,genus,lon,lat"; for (i = 0; i < 40; i++) printf "%s,quercus,%f,48.1\n", i ? "" : "Quercus robur", 11.5 + i / 5000 }' >"$DIR/sparse.csv"
start 0 'species *"genus"' sparse.csv

# ---- Two of 40 rows have a height: the others are as high as their form usually is ----
awk 'BEGIN { print "species,lon,lat,height_m"; for (i = 0; i < 40; i++) printf "oak,%f,48.1,%s\n", 11.5 + i / 5000, i < 2 ? 2 : "" }' >"$DIR/few.csv"
start 0 'usual for a broad-leaved tree; only 5 % of the rows have a height' few.csv
is '.instances[0].height_m[1]' 12

# ---- Questions, each with its choices and the option that answers ----
awk 'BEGIN { print "species,x,y,height_m"; for (i = 0; i < 20; i++) printf "oak,%d,%d,%d\n", 691600 + i, 5334700 + i, 9 + i % 9 }' >"$DIR/zone.csv"
start 1 'which CRS .* each UTM zone, at latitude 48\.1.*--crs EPSG:32601' zone.csv
grep -q "or the country's grid, .*UTM" "$DIR/out" && complain "a UTM zone is called a country's grid: $(cat "$DIR/out")"
sed 1d "$DIR/zone.csv" >"$DIR/bare.csv"
start 1 'which columns say where.*if that is the first plant, put a line of names before it' bare.csv
start 0 'as you say' zone.csv --crs EPSG:25832
is '[.crs, .instances[0].crs]' '["EPSG:25832","EPSG:25832"]'
start 0 'crs of the scene EPSG:32633 .as you say' zone.csv --crs EPSG:25832 --scene-crs EPSG:32633
is .crs '"EPSG:32633"'
sed 's/height_m/height/' "$DIR/zone.csv" | awk -F, 'BEGIN { OFS = "," } NR > 1 { $4 = 15 + NR } { print }' >"$DIR/unit.csv"
start 1 'in which unit is "height".* if in m, .* if in ft; say --height-unit' unit.csv --crs EPSG:26917
start 0 '"height" in m' unit.csv --crs EPSG:25832
start 0 '"height" in ft' unit.csv --crs EPSG:25832 --height-unit ft
awk -F, 'BEGIN { OFS = "," } NR > 1 { $4 = 110 + NR } { print }' "$DIR/zone.csv" >"$DIR/tall.csv"
start 1 'in which unit is "height_m".*122 m if in m, .* if in ft; say --height-unit' tall.csv --crs EPSG:25832
start 2 'the units are m, dm, cm' tall.csv --crs EPSG:25832 --height-unit yards
start 1 'no such column; there are: species, x, y, height_m' zone.csv --crs EPSG:25832 --species-column kind
start 1 'the CRS "EPSG:1" is not known' zone.csv --crs EPSG:1
sed 's/species/what/; s/^oak/7/' "$DIR/zone.csv" >"$DIR/nameless.csv"
start 1 'which column names the species.*there are: what.*--plant NAME for one model everywhere .*stieleiche' nameless.csv --crs EPSG:25832
start 0 'as you say' nameless.csv --crs EPSG:25832 --plant norway_spruce
is '.instances[0].plant' '"norway_spruce"'
echo 'a,b' >"$DIR/empty.csv"
start 1 'it has no rows' empty.csv

# ---- A terrain that says no CRS; it leaves plants outside ----
dem() { # NAME FACTOR
	awk -v f="$2" 'BEGIN { print "ncols 21\nnrows 21\nxllcorner 691505\nyllcorner 5334605\ncellsize 10"
		for (y = 0; y < 21; y++) { for (x = 0; x < 21; x++) printf "%g ", f * (500 + 5 * sin(x / 3) + y); print "" } }' >"$DIR/$1.asc"
}
dem metres 1; dem centimetres 100
awk 'BEGIN { print "species,x,y,height_m"; for (i = 0; i < 40; i++) printf "oak,%d,%d,%d\n", 691510 + 5 * i, 5334700, 9 + i % 9; print "oak,691300,5334700,8\noak,691600,5334900,8" }' >"$DIR/off.csv"
"$PACK" start "$DIR/off.csv" "$DIR/models/stieleiche.obj" "$DIR/metres.asc" -o "$DIR/hill" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "hill: $(cat "$DIR/out")"
grep -q '2 of 42 plants stand beyond its border' "$DIR/out" || complain "hill: $(cat "$DIR/out")"
[ "$(jq -c '[.ground.crs, .ground.heights]' "$DIR/hill/scene.json")" = '["EPSG:25832","../metres.asc"]' ] || complain "hill: $(jq -c .ground "$DIR/hill/scene.json")"
jq -e '.keyframes[0].eye[2] > 505 and .keyframes[0].target[2] > 500' "$DIR/hill/camera.json" >/dev/null || complain "hill: $(cat "$DIR/hill/camera.json")"
mkdir "$DIR/tiles" && cp "$DIR/metres.asc" "$DIR/tiles"
"$PACK" start "$DIR/off.csv" "$DIR/models/stieleiche.obj" "$DIR/tiles" -o "$DIR/tiled" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "tiles: $(cat "$DIR/out")"
[ "$(jq -c .ground.heights "$DIR/tiled/scene.json")" = '"../tiles/metres.asc"' ] || complain "tiles: $(jq -c .ground "$DIR/tiled/scene.json")"
sed 's/metres.asc/centimetres.asc/' "$DIR/hill/scene.json" >"$DIR/hill/steep.json"
"$PACK" make --draft "$DIR/hill/steep.json" -o "$DIR/hill/steep.eco" >"$DIR/out" 2>&1 || complain "steep: $(cat "$DIR/out")"
grep -q 'one slope in ten rises more than .* are its heights in another unit' "$DIR/out" || complain "steep: $(grep -v building "$DIR/out")"
grep -q '2 plants or nested scenes stand beyond its border (1 west, 1 north of it, up to 2.. m away)' "$DIR/out" || complain "steep: $(grep -v building "$DIR/out")"
sed 's/"heights": "..\/metres.asc"/"heights": "..\/centimetres.asc", "unit": "cm"/' "$DIR/hill/scene.json" >"$DIR/hill/stated.json"
"$PACK" make --draft "$DIR/hill/stated.json" -o "$DIR/hill/stated.eco" >"$DIR/out" 2>&1 || complain "stated: $(cat "$DIR/out")"
grep -q 'one slope in ten' "$DIR/out" && complain "make doubts a unit that the scene states"

# ---- A picture of the ground: told from heights by its bands; asked about where these do not say ----
grid() { # NAME EXPRESSION of x and y: 21 x 21 cells of 10 m
	awk "BEGIN { print \"ncols 21\\nnrows 21\\nxllcorner 691505\\nyllcorner 5334605\\ncellsize 10\"
		for (y = 0; y < 21; y++) { for (x = 0; x < 21; x++) printf \"%d \", $2; print \"\" } }" >"$DIR/$1.asc"
}
band() { # NUMBER COLOUR FILE
	printf '<VRTRasterBand dataType="Byte" band="%d"><ColorInterp>%s</ColorInterp><SimpleSource><SourceFilename relativeToVRT="1">%s.asc</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand>' "$@"
}
vrt() { # NAME BANDS
	printf '<VRTDataset rasterXSize="21" rasterYSize="21"><GeoTransform>691505,10,0,5334815,0,-10</GeoTransform>%s</VRTDataset>\n' "$2" >"$DIR/$1.vrt"
}
grid red '12 * x'; grid green '12 * y'; grid blue 40
vrt photo "$(band 1 Red red)$(band 2 Green green)$(band 3 Blue blue)"
vrt grey "$(band 1 Gray red)"
ground() { # STATUS PATTERN RASTER OPTION...
	wanted=$1 pattern=$2 table="rasters $3 ${4:-}"; shift 2
	rm -rf "$DIR/my"
	"$PACK" start "$DIR/off.csv" "$DIR/models/stieleiche.obj" "$@" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1 </dev/null
	status=$?
	[ $status -eq "$wanted" ] || complain "$table: status $status instead of $wanted: $(tail -c 600 "$DIR/out")"
	tr -s '\n ' ' ' <"$DIR/out" | grep -Eq -- "$pattern" || complain "$table: says nothing like /$pattern/: $(cat "$DIR/out")"
}
ground 0 'picture .*photo.vrt .it has 3 bands of Byte.*terrain .*metres.asc .it has 1 band of' "$DIR/photo.vrt" "$DIR/metres.asc"
is '[.ground.heights, .ground.image]' '["../metres.asc",{"file":"../photo.vrt","crs":"EPSG:25832"}]'
grep -q 'photo.vrt: the image lies from .* in the scene and does not reach all plants' "$DIR/out" || complain "photo: $(cat "$DIR/out")"
ground 0 'its file says none, and in the scene.s the plants. middle lies on it' "$DIR/photo.vrt"
is '.ground | has("heights")' false
ground 1 'heights, or a picture of the ground. it has 1 band of Byte; say --dem .*grey.vrt or --image' "$DIR/grey.vrt"
ground 0 'are written' --dem "$DIR/grey.vrt" --image "$DIR/photo.vrt"
is '[.ground.heights, .ground.image.file]' '["../grey.vrt","../photo.vrt"]'
ground 1 'both are rasters of heights' "$DIR/metres.asc" "$DIR/centimetres.asc"
ground 0 'crs of the picture EPSG:25832 .as you say' --image "$DIR/photo.vrt" --image-crs EPSG:25832
for raster in metres.asc photo.vrt; do
	"$PACK" start "$DIR/$raster" "$DIR/models" -o "$DIR/my" --force >"$DIR/out" 2>&1 && complain "it took $raster for plants"
	grep -q "$raster is a raster, no table of plants: rasters come last" "$DIR/out" || complain "$raster: $(cat "$DIR/out")"
done
sed 's/691505/191505/' "$DIR/photo.vrt" >"$DIR/afar.vrt"
ground 1 'in which CRS is it.*say --image-crs' "$DIR/afar.vrt"

# ---- Columns as towns and surveyors write them: NAMES|ROW|WHAT IS SAID|FILTER|VALUE; a # in ROW is a number that counts, each fifth row may differ: ROW~ROW ----
while IFS='|' read -r names row says filter value; do
	awk -v names="$names" -v row="$row" 'BEGIN { print names; for (i = 0; i < 40; i++) { split(row "~" row, either, "~"); s = either[i % 5 ? 1 : 2]; gsub(/#/, 10 + i, s); print s } }' >"$DIR/towns.csv"
	start 0 "$says" towns.csv
	table="$names"
	is "$filter" "$value"
done <<'TABLE'
Art;Lat;Lon|Linde;48° 08' 14,#" N;11° 34' 0,#" E||.crs|"EPSG:32632"
species;lat;lon|oak;40:24:#.5N;003:41:#.5W||.crs|"EPSG:32630"
species;lat;lon|oak;40d24m#s N;3d41m#s W||.crs|"EPSG:32630"
species,lon,lat,height_m,crown_ns_m,crown_ew_m|oak,11.5,48.1#,12,6,8|other directions|.instances[0].crown_m|{"column":["crown_ns_m","crown_ew_m"],"is":"diameter","unit":"m","otherwise":"species","spread":0.15}
Art,lon,lat,Baumstatus|Eiche,11.5,48.1#,gut~Eiche,11.5,48.1#,gefällt|32 plants|.instances[0].skip|{"Baumstatus":["gefällt"]}
species,lon,lat,removal_year|oak,11.5,48.1#,~oak,11.5,48.1#,2019|32 plants|.instances[0].skip|{"removal_year":["2019"]}
essence,lon,lat|POPNIG,2.3,48.8#~ACEPLA,2.3,48.8#|codes of letters|.instances[0].codes|"letters"
species,geom|oak,0101000020E6100000000000000000F83F0000000000000440||.crs|"EPSG:32631"
species,geom|oak,50°06'#"N 8°39'#"E||.crs|"EPSG:32632"
species,lon,lat,Removal cost|oak,11.5,48.1#,250#||.instances[0].skip|null
species,lon,lat,crown_dim2|oak,11.5,48.1#,#|a diameter|.instances[0].crown_m.is|"diameter"
species,lon,lat,canopy_m2|oak,11.5,48.1#,#|an area, in squares|.instances[0].crown_m|{"column":"canopy_m2","is":"area","unit":"m"}
Art,lon,lat,Krone_N,Krone_O,Krone_S,Krone_W|Eiche,11.5,48.1#,2,3,4,5||.instances[0].crown_m.column|["Krone_N","Krone_O","Krone_S","Krone_W"]
Art,lon,lat,Bemerkung|Eiche,11.5,48.1#,Stubben daneben entfernt~Eiche,11.5,48.1#,Stubben|32 plants|.instances[0].skip|{"Bemerkung":["Stubben"]}
Art,lon,lat,Zustand|Eiche,11.5,48.1#,gut~Eiche,11.5,48.1#,tot|8 rows where .Zustand. is tot.*40 plants|.instances[0].skip|null
Art,lon,lat|Eiche,11.5,48.1#~Toter Baum,11.5,48.1#|32 plants|.instances[0].map["Toter Baum"]|null
leaf_type,lon,lat|broadleaved,11.5,48.1#~needleleaved,11.5,48.1#||.instances[0].species|"leaf_type"
species,lon,lat,height,dbh|oak,11.5,48.1#,30,#0|may be a girth|.instances[0].height_m[1].from_dbh|"dbh"
TABLE
start 0 'trunk girth "dbh"' towns.csv --girth-column dbh --dbh-unit cm
start 1 'give one' towns.csv --girth-column dbh --dbh-column dbh
awk 'BEGIN { print "lon,lat,zmax"; for (i = 0; i < 40; i++) printf "11.5,48.1%d,%d.25\n", 10 + i, 10 + i }' >"$DIR/tops.csv"
start 0 'normalised cloud' tops.csv --plant linden
is '.instances[0].height_m[0].column' '"zmax"'
awk 'BEGIN { print "WKT"; for (i = 0; i < 40; i++) printf "POINT Z (11.5 48.1%d %d.25)\n", 10 + i, 10 + i }' >"$DIR/high.csv"
start 0 'normalised cloud.*40 measured' high.csv --plant linden
is '.instances[0].height_m[0].column' '"geometry"'

# ---- A plan: blocks on layers that name plants, and others ----
awk 'function insert(layer, block, x) { printf "0\nINSERT\n8\n%s\n2\n%s\n10\n%d\n20\n5334700\n", layer, block, x }
	BEGIN { print "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS"
	split("QUERCUS_ROBUR BANK", names, " "); for (i = 1; i < 3; i++) printf "0\nBLOCK\n8\n0\n2\n%s\n10\n0\n20\n0\n0\nENDBLK\n8\n0\n", names[i]
	print "0\nENDSEC\n0\nSECTION\n2\nENTITIES"
	for (i = 0; i < 6; i++) insert(i % 3 ? "GEHOELZE" : "MOEBEL", i % 3 ? names[1] : names[2], 691600 + 10 * i)
	print "0\nENDSEC\n0\nEOF" }' >"$DIR/plan.dxf"
start 0 'what is on MOEBEL.*4 plants' plan.dxf --crs EPSG:25832
is '.instances[0].skip' '{"Layer":["MOEBEL"]}'

# ---- Arguments in another order, or of another kind ----
order() { # PATTERN ARGUMENT...
	pattern=$1 table="order of $*"; shift
	rm -rf "$DIR/my"
	"$PACK" start "$@" -o "$DIR/my" >"$DIR/out" 2>&1 </dev/null && complain "$table: it is taken"
	tr -s '\n ' ' ' <"$DIR/out" | grep -Eq -- "$pattern" || complain "$table: says nothing like /$pattern/: $(cat "$DIR/out")"
	[ ! -e "$DIR/my" ] || complain "$table: left $(ls "$DIR/my")"
}
printf 'species,x,y\nrock,0,0\n' >"$DIR/table.csv"
rm -rf "$DIR/my"; table='any order'
"$PACK" start "$DIR/metres.asc" "$DIR/models" "$DIR/table.csv" -o "$DIR/my" >"$DIR/out" 2>&1 || complain "$table: $(cat "$DIR/out")"
is '[.ground.heights, .instances[0].from, .plants.rock.model]' '["../metres.asc","../table.csv","../models/rock.obj"]'
rm -rf "$DIR/my"
order 'TREES, .*/models, is a folder' "$DIR/models" "$DIR/models"
{ cat "$DIR/table.csv"; echo oak,1,1; } >"$DIR/table2.csv"
order 'MODELS, .*/table2.csv, a table: .*the other a folder or a model .\.glb' "$DIR/table.csv" "$DIR/table2.csv"
printf 'glTF' >"$DIR/forest.glb"
order 'forest.glb, is a model' "$DIR/forest.glb" "$DIR/models"

# ---- Footprints of buildings: polygons beside the trees, at any place among the arguments ----
square() { printf '{"type":"Feature","properties":{%s},"geometry":{"type":"Polygon","coordinates":[[[%d,5334700],[%d,5334700],[%d,5334709],[%d,5334700]]]}}' \
	"$1" "$2" $(($2 + 9)) $(($2 + 9)) "$2"; }
{
	printf '{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}},"features":['
	square '"roof:levels":"1","min_height":"0","height":"12.5","building:levels":"4","roof:shape":"gabled"' 691600; printf ,
	square '"roof:levels":"1","min_height":"2","height":null,"building:levels":"2","roof:shape":null' 691620; printf ']}'
} >"$DIR/houses.geojson"
awk 'BEGIN { print "species,x,y,height_m"; for (i = 0; i < 30; i++) printf "oak,%d,%d,12\n", 691600 + i, 5334700 + 2 * i }' >"$DIR/trees.csv"
for order in "trees.csv models houses.geojson" "houses.geojson trees.csv models"; do
	rm -rf "$DIR/my"; table="buildings: $order"
	(cd "$DIR" && "$OLDPWD/$PACK" start $order --crs EPSG:25832 -o my) >"$DIR/out" 2>&1 || complain "$table: $(cat "$DIR/out")"
	grep -q '2 of the first 2' "$DIR/out" || complain "$table: not said: $(cat "$DIR/out")"
	grep -q '"height" in m ' "$DIR/out" && grep -q '"building:levels", 3 m each ' "$DIR/out" || complain "$table: units: $(cat "$DIR/out")"
	is '.instances | length' 2
	is '.instances[1]' '{"height_m":[{"column":"height","unit":"m"},{"storeys":"building:levels","storey_m":3},6],"roof":"roof:shape","extrude":"../houses.geojson"}'
done
# a lone table is that of the trees
{
	printf '{"type":"FeatureCollection","crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}},"features":['
	square '"species":"Quercus robur"' 691600; printf ,; square '"species":"Tilia cordata"' 691640; printf ']}'
} >"$DIR/crowns.geojson"
start 0 'polygon' crowns.geojson
is '.instances | length' 1
# crowns are no buildings; a plot without a CRS has footprints without one
start 0 'buildings .*/houses.geojson' crowns.geojson "$DIR/houses.geojson"
is '.instances[1].extrude' '"../houses.geojson"'
awk 'BEGIN { print "species,x,y,height_m"; for (i = 0; i < 30; i++) printf "oak,%d,%d,12\n", i, 2 * i }' >"$DIR/plain.csv"
{ printf '{"type":"FeatureCollection","crs":null,"features":['; square '"levels":2' 20; printf ']}'; } >"$DIR/plot_houses.geojson"
start 0 'buildings .*/plot_houses.geojson' plain.csv "$DIR/plot_houses.geojson"
is '.instances[1] | has("crs")' false
# roads and land use are drawn, an extract of OpenStreetMap is all of it; woods and tree rows are scattered
line() { printf '{"type":"Feature","properties":{%s},"geometry":{"type":"LineString","coordinates":[[691600,5334700],[691660,5334720]]}}' "$1"; }
at='"crs":{"type":"name","properties":{"name":"urn:ogc:def:crs:EPSG::25832"}}'
{ printf '{"type":"FeatureCollection",%s,"features":[' "$at"; line '"highway":"track","width":"3"'; printf ']}'; } >"$DIR/roads.geojson"
{ printf '{"type":"FeatureCollection",%s,"features":[' "$at"; square '"use":"Wald"' 691700; printf ,; square '"use":"Wiese"' 691720; printf ']}'; } >"$DIR/use.geojson"
{ printf '{"type":"FeatureCollection",%s,"features":[' "$at"; square '"building":"yes"' 691700; printf ,; square '"landuse":"grass"' 691720; printf ']}'; } >"$DIR/both.geojson"
start 0 'buildings .*/both.geojson .*ground .*/both.geojson' trees.csv "$DIR/both.geojson" --crs EPSG:25832
is '[.ground.draw[0].from, .instances[1].skip]' '["../both.geojson",{"building":["","no"]}]'
start 0 'ground .*/roads.geojson .*woods 1 wood, a plant every 7 m' trees.csv "$DIR/roads.geojson" "$DIR/use.geojson" --crs EPSG:25832
is '.ground' '{"draw":[{"from":"../roads.geojson","width_m":"width"},{"from":"../use.geojson"}]}'
is '.instances[1] | [.scatter, .only, (.density_per_ha | length), .height_m.max > 10]' '["../use.geojson",{"use":["Wald"]},3,true]'
{
	printf '<?xml version="1.0"?><osm version="0.6"><node id="1" lat="48" lon="11"/><node id="2" lat="48" lon="11.001"/><node id="3" lat="48.001" lon="11.001"/>'
	awk 'BEGIN { for (i = 10; i < 20; i++) printf "<node id=\"%d\" lat=\"48.000%d\" lon=\"11.000%d\"><tag k=\"natural\" v=\"tree\"/><tag k=\"species\" v=\"Tilia cordata\"/><tag k=\"height\" v=\"%d\"/></node>", i, i, i, i }'
	way() { printf '<way id="%d">%s%s</way>' "$1" "$3" "$(printf '%s' "$2" | awk -F= '{ printf "<tag k=\"%s\" v=\"%s\"/>", $1, $2 }')"; }
	way 1 highway=residential '<nd ref="1"/><nd ref="2"/>'; way 2 natural=tree_row '<nd ref="2"/><nd ref="3"/>'
	ring='<nd ref="1"/><nd ref="2"/><nd ref="3"/><nd ref="1"/>'
	way 3 building=yes "$ring"; way 4 natural=wood "$ring"; way 5 landuse=forest "$ring"; printf '</osm>'
} >"$DIR/town.osm"
head -c 900 "$DIR/town.osm" >"$DIR/cut.osm"
start 1 'cut.osm: it cannot be read, as it is damaged' trees.csv "$DIR/cut.osm" --crs EPSG:25832
start 0 'single trees .*natural=tree' town.osm
is '.instances | map(.from // .extrude // .scatter)' '["../town.osm","../town.osm","../town.osm","../town.osm","../town.osm"]'
is '.ground.draw | map(.layer)' '["multipolygons","lines"]'
is '.instances[1].skip' '{"building":["","no"]}'
is '.instances[3] | [.only, .skip]' '[{"landuse":["forest"]},{"natural":["wood"]}]'
is '.instances[4] | [.only, .spacing_m, (.mix | length)]' '[{"natural":["tree_row"]},9,1]'
rm -rf "$DIR/my"; table='extract first'
"$PACK" start "$DIR/town.osm" "$DIR/trees.csv" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "$table: $(cat "$DIR/out")"
is '[.instances[0].from, (.instances | length)]' '["../trees.csv",5]'
# a copy is one file
cp "$DIR/town.osm" "$DIR/copy.osm"; rm -rf "$DIR/my"; table='copies'
"$PACK" start "$DIR/town.osm" "$DIR/copy.osm" "$DIR/trees.csv" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "$table: $(cat "$DIR/out")"
grep -q 'copy.osm: left out, as .*/town.osm has the same bytes' "$DIR/out" || complain "$table: $(cat "$DIR/out")"
is '.instances | length' 5
# models of buildings, by their shape or names: at the scene's origin, in map coordinates where these say
house() { awk -v x="$1" -v y="$2" -v z="$3" -v up="$4" 'BEGIN {
	split("-10 -5 0 10 -5 0 10 5 0 -10 5 0 -10 -5 6 10 -5 6 10 5 6 -10 5 6 -10 0 9 10 0 9", p, " ")
	for (i = 0; i < 10; i++) { a = p[3*i+1] + x; b = p[3*i+2] + y; c = p[3*i+3] + z; printf "v %.2f %.2f %.2f\n", a, up == "z" ? b : c, up == "z" ? c : -b }
	print "f 1 2 6 5\nf 2 3 7 10 6\nf 3 4 8 7\nf 4 1 5 9 8\nf 5 6 10 9\nf 7 8 9 10" }'; }
house 691640.5 5334720.25 512 z >"$DIR/map.obj"; house 0 0 0 y >"$DIR/own.obj"; house 200000 5334720 0 z >"$DIR/far.obj"
mkdir -p "$DIR/houses" && cp "$DIR/own.obj" "$DIR/houses/a.obj" && house 30 0 0 z >"$DIR/houses/b.obj"
start 0 'building .*/map.obj .*walls and floors; its numbers are the map.s.*z points up.*building .*/own.obj .*its zero stands at' trees.csv \
	"$DIR/map.obj" "$DIR/own.obj" "$DIR/houses" --crs EPSG:25832
is '.plants | [.map.object, .map.up, .map.foot, .own.foot, .own.up, .a.object, .b.up]' '[true,"z",[691640,5334720,512],null,null,true,"z"]'
is '.plants.stieleiche.object' null
is '[(.instances[1].at[0] + .origin[0]), .instances[2].at, (.instances | length)]' '[691640,[0,0],5]'
"$PACK" map "$DIR/my/scene.json" -o "$DIR/map.png" >"$DIR/out" 2>&1 && grep -q '34 plants' "$DIR/out" || complain "objects: $(cat "$DIR/out")"
# a long name is cut after a whole character; one that is no UTF-8 is refused
long="$DIR/Das Rathaus der Stadtverwaltungen Südtü.obj" odd="$DIR/$(printf 'h\377').obj"
cp "$DIR/own.obj" "$long"; cp "$DIR/own.obj" "$odd"
start 0 'building .*Rathaus' trees.csv "$long" --crs EPSG:25832
is '.instances[1].plant' '"Das Rathaus der Stadtverwaltungen Südt"'
cp "$DIR/own.obj" "$DIR/..obj"
start 0 'building .*obj' trees.csv "$DIR/..obj" --crs EPSG:25832
is '.instances[1].plant' '"obj"'
start 1 'a building, as .*its name is no UTF-8, .*rename it' trees.csv "$odd" --crs EPSG:25832
start 1 'far.obj: a building, as .* it lies 200 km from the trees.*in which CRS is it' trees.csv "$DIR/far.obj" --crs EPSG:25832
# a preview beside folders of models is no terrain
mkdir -p "$DIR/sorts/oak" && cp "$DIR/models/stieleiche.obj" "$DIR/sorts/oak" && : >"$DIR/sorts/preview.jpg"
"$PACK" start "$DIR/trees.csv" "$DIR/sorts" -o "$DIR/sorted" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "sorts: $(cat "$DIR/out")"

# ---- Nothing is replaced by mistake, and nothing half written ----
start 0 '' zone.csv --crs EPSG:25832
cp "$DIR/my/scene.json" "$DIR/kept.json"
"$PACK" start "$DIR/plot.csv" "$DIR/models" -o "$DIR/my" >"$DIR/out" 2>&1 && complain "it replaced a scene"
grep -q -- '--force replaces it' "$DIR/out" || complain "it does not say --force: $(cat "$DIR/out")"
"$PACK" start "$DIR/empty.csv" "$DIR/models" -o "$DIR/my" --force >"$DIR/out" 2>&1 && complain "it took an empty table"
cmp -s "$DIR/kept.json" "$DIR/my/scene.json" || complain "a failure changed the scene"
[ "$(ls "$DIR/my" | tr '\n' ' ')" = "camera.json map.png scene.json " ] || complain "there are $(ls "$DIR/my")"
"$PACK" start "$DIR/plot.csv" "$DIR/models" -o "$DIR/my" --force -q >"$DIR/out" 2>&1 || complain "--force: $(cat "$DIR/out")"
grep -q EPSG "$DIR/out" && complain "--quiet says: $(cat "$DIR/out")"

# ---- What is guessed is a pack, and says what of it can hardly be meant ----
"$PACK" make --draft "$DIR/my/scene.json" -o "$DIR/my.eco" -q >"$DIR/out" 2>&1 || complain "make: $(cat "$DIR/out")"
"$PACK" info "$DIR/my.eco" --json | jq -e '.instances == 90' >/dev/null || complain "90 rows are $("$PACK" info "$DIR/my.eco" --json | jq .instances) plants"
model aspen 103
cat >"$DIR/doubts.json" <<JSON
{"notes": "sizes that no such plant has", "plants": {"aspen": {"model": "models/aspen.obj"}, "a rock": {"model": "models/rock.obj"}, "oak": {"model": "models/stieleiche.obj"},
 "bonsai oak": {"model": "models/stieleiche.obj", "height_m": 0.5}},
 "instances": [{"plant": "aspen", "at": [0, 0]}, {"plant": "a rock", "at": [5, 5]}, {"plant": "oak", "at": [9, 9], "height_m": 1.1}, {"plant": "bonsai oak", "at": [3, 3]}]}
JSON
"$PACK" make --draft "$DIR/doubts.json" -o "$DIR/doubts.eco" >"$DIR/out" 2>&1 || complain "doubts: $(cat "$DIR/out")"
says() { grep -Eq -- "$1" "$DIR/out" || complain "make says nothing like /$1/: $(grep -v building "$DIR/out" | head -c 900)"; }
says 'aspen: half of its 1 plants are more than 103 m high, where a broad-leaved tree has 2 to 50 m'
says 'a rock: by its name it is no plant'
says 'oak: half of its 1 plants are less than 1.1 m high'
grep -q 'bonsai.*half' "$DIR/out" && complain "make doubts a height that the scene states"

# ---- A species of a model's whole name gets it; variants without a unit keep their own heights ----
mkdir "$DIR/same" && for n in 1 2; do sed '/Units/d' "$DIR/models/linden_2.obj" | awk -v n=$n '$1 == "v" { $3 *= n / 2 } { print }' >"$DIR/same/ash_$n.obj"; done
for name in tree treeTall tree_of_all; do cp "$DIR/models/stieleiche.obj" "$DIR/same/$name.obj"; done
awk 'BEGIN { print "species,x,y"; for (i = 0; i < 40; i++) printf "%s,%d,%d\n", i % 4 == 0 ? "Tree" : i % 4 == 1 ? "tree tall" : i % 4 == 2 ? "tree-of-all" : "ash", i, i % 7 }' >"$DIR/same.csv"
rm -rf "$DIR/my"
"$PACK" start "$DIR/same.csv" "$DIR/same" -o "$DIR/my/" >"$DIR/out" 2>&1 || complain "same: $(cat "$DIR/out")"
table=same.csv
is '.instances[0].map | [.Tree, ."tree tall", ."tree-of-all"]' '["tree","treeTall","tree_of_all"]'
is '.plants.ash | [(.variants | length), has("height_m")]' '[2,false]'
rm -rf "$DIR/my"

# ---- A terrain tells the grid of a table that says none: the one that puts the plants on it, or its own that nobody states ----
awk 'BEGIN { print "species,x,y"; for (i = 0; i < 40; i++) printf "oak,%d,%d\n", 656100 + 10 * i, 218200 + 7 * (i % 9) }' >"$DIR/there.csv"
grid() { # NAME X Y
	printf 'ncols 21\nnrows 21\nxllcorner %d\nyllcorner %d\ncellsize 50\nNODATA_value -9999\n' "$2" "$3" >"$DIR/$1.asc"
	awk 'BEGIN { for (y = 0; y < 21; y++) { for (x = 0; x < 21; x++) printf "%d ", 500 + x + y; print "" } }' >>"$DIR/$1.asc"
}
grid swiss 2655800 1217800; grid bare 655800 217800
cat >"$DIR/swiss.vrt" <<'END'
<VRTDataset rasterXSize="21" rasterYSize="21"><SRS>EPSG:2056</SRS><GeoTransform>2655800, 50, 0, 1218850, 0, -50</GeoTransform><VRTRasterBand
dataType="Int32" band="1"><SimpleSource><SourceFilename relativeToVRT="1">swiss.asc</SourceFilename><SourceBand>1</SourceBand></SimpleSource></VRTRasterBand></VRTDataset>
END
start 0 'EPSG:21781 .CH1903 / LV03, the only one where the terrain is' there.csv "$DIR/swiss.vrt"
is '[.crs, .ground.heights]' '["EPSG:21781","../swiss.vrt"]'
start 0 'metres of the terrain.s grid, which says no CRS either' there.csv "$DIR/bare.asc"
is '[has("crs"), .origin]' '[false,[656300,218230]]'
start 1 'which CRS are its coordinates in' there.csv

# ---- A place of each UTM zone; lines are no plants ----
awk 'BEGIN { print "tree,easting,northing,height"; for (i = 0; i < 40; i++) printf "oak,%d,%d,%d\n", 477500 + i, 5632100 + i, 5 + i % 9 }' >"$DIR/english.csv"
start 1 'is a place in each UTM zone' english.csv
echo '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"tree":"oak"},"geometry":{"type":"LineString","coordinates":[[8,47],[8.1,47.1]]}}]}' >"$DIR/lines.geojson"
start 1 'no row is a point; a table of plants has a point for each' lines.geojson

echo '{"type":"FeatureCollection","features":[{"type":"Feature","properties":{},"geometry":{"type":"Point","coordinates":[8,47]}}]}' >"$DIR/bare.geojson"
start 1 'it has no columns, so no species; give --plant NAME for one model everywhere' bare.geojson

# ---- A model of the very name stands for what is else no plant; one plant at zero is no place in the sea ----
printf 'species,x,y\nrock,0,0\n' >"$DIR/rock.csv"
start 0 'metres of a plot: from 0, 0 to 0, 0' rock.csv
is '[.crs, .instances[0].map.rock]' '[null,"rock"]'

# ---- Levels of detail in files of their own are no variants ----
mkdir "$DIR/levels" && for level in 0 1 2; do cp "$DIR/models/stieleiche.obj" "$DIR/levels/oak_LOD$level.obj"; done
rm -rf "$DIR/my"
"$PACK" start "$DIR/zone.csv" "$DIR/levels" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "levels: $(cat "$DIR/out")"
is '.plants | [.[] | .model // .variants] | length' 1
jq -r '.. | strings' "$DIR/my/scene.json" | grep -q 'LOD[12]' && complain "levels: LOD1 or LOD2 is a variant"
grep -q 'oak_LOD2.obj: left out, as .*oak_LOD0.obj is a finer level of it' "$DIR/out" || complain "levels: $(cat "$DIR/out")"

# ---- Models in folders of their own, as sites give them: the folder names them, and different files of one name are different models ----
mkdir -p "$DIR/sites/rubra_oak/source" "$DIR/sites/tall_spruce/obj" "$DIR/sites/linden" "$DIR/sites/holly"
cp "$DIR/models/stieleiche.obj" "$DIR/sites/rubra_oak/source/scene.obj"
cp "$DIR/models/norway_spruce.obj" "$DIR/sites/tall_spruce/obj/Model.obj"
cp "$DIR/models/linden_2.obj" "$DIR/sites/linden/big.obj"
cp "$DIR/models/holly_bush.obj" "$DIR/sites/holly/big.obj"
cp "$DIR/models/holly_bush.obj" "$DIR/sites/holly/small.obj"
cp "$DIR/models/holly_bush.obj" "$DIR/sites/small.obj"
# sites MODELS: into $DIR/my
sites() {
	rm -rf "$DIR/my"
	"$PACK" start "$DIR/de.csv" "$DIR/$1" -o "$DIR/my" >"$DIR/out" 2>&1 || complain "sites: $(cat "$DIR/out")"
}
sites sites
grep -q 'sites: 5 models' "$DIR/out" && grep -q 'sites/small.obj: left out, as .*sites/holly/small.obj is the same model' "$DIR/out" ||
	complain "sites: $(cat "$DIR/out")"
is '.instances[0].map | [."Quercus robur", ."Tilia cordata"]' '["rubra_oak","linden big"]'
cp "$DIR/models/linden_2.obj" "$DIR/sites/rubra_oak/scene.obj"
sites sites/rubra_oak/scene.obj
is '.plants | keys' '["rubra_oak"]'
sites sites/tall_spruce/
is '.plants | keys' '["quercus spreading","tilia cordata oval"]'
is '.plants["quercus spreading"] | [.library, .genus, (.height_m | length), .individual]' '["spreading","quercus",2,[1,2]]'
tr -s '\n ' ' ' <"$DIR/out" | grep -q 'no model has their form: the library grows it' || complain "library: $(cat "$DIR/out")"

# ---- No models at all: the library grows every plant, as old as its rows say; one habit, if no column says a species ----
rm -rf "$DIR/my"
"$PACK" start "$DIR/de.csv" -o "$DIR/my" >"$DIR/out" 2>&1 || complain "no models: $(cat "$DIR/out")"
is '.instances[0].map | keys' '["*","Quercus robur","Tilia cordata"]'
is '[.plants[] | .height_m[-1] / .height_m[0] < 3]' '[true,true]'
"$PACK" make --draft "$DIR/my/scene.json" -o "$DIR/my.eco" -q >"$DIR/out" 2>&1 || complain "no models: $(cat "$DIR/out")"
"$PACK" info "$DIR/my.eco" --json | jq -e '.instances == 60 and (.plants | length) == 8' >/dev/null || complain "no models: $("$PACK" info "$DIR/my.eco")"
"$PACK" make --draft --season winter "$DIR/my/scene.json" -o "$DIR/my.eco" -q >"$DIR/out" 2>&1 || complain "winter: $(cat "$DIR/out")"
"$PACK" info "$DIR/my.eco" --json | jq -e '[.plants[].organs | has("wood") and (has("foliage") | not)] | all' >/dev/null || complain "oaks and lindens have leaves in winter"
rm -rf "$DIR/my"
"$PACK" start "$DIR/off.csv" "$DIR/metres.asc" -o "$DIR/my" --crs EPSG:25832 --plant vase >"$DIR/out" 2>&1 || complain "a habit: $(cat "$DIR/out")"
is '[.ground.heights, .plants.vase.library]' '["../metres.asc","vase"]'

# ---- Three palms among trees of no species: the others are no palms ----
awk 'BEGIN { print "species,x_m,y_m"; for (i = 0; i < 60; i++) printf "%s,%d,%d\n", i % 20 ? "" : "Phoenix canariensis", i % 8 * 5, i * 3 }' >"$DIR/few.csv"
rm -rf "$DIR/my"
"$PACK" start "$DIR/few.csv" -o "$DIR/my" >"$DIR/out" 2>&1 || complain "few palms: $(cat "$DIR/out")"
is '.plants[.instances[0].map | .["*"], .["Phoenix canariensis"]] | [.library, .individual]' '["round",[1,2]]
["feather palm",null]'

# ---- Dead trees stand as dead ones: the model of one, else the library's; crowns begin where they were measured ----
awk 'BEGIN { print "species,x_m,y_m,height_m,status,crown base height (m)"
	for (i = 0; i < 60; i++) printf "Picea abies,%d,%d,%d,%s,%.1f\n", i % 8 * 5, i * 3, 20 + i % 5, i % 6 ? "Alive" : "Dead", 10 + i % 5 / 2 }' >"$DIR/dead.csv"
start 0 '10 rows where "status" is Dead .they stand as dead trees' dead.csv
is '.instances[0].instead' '{"maple_dead":{"status":["Dead"]}}'
rm -rf "$DIR/my"
"$PACK" start "$DIR/dead.csv" -o "$DIR/my" >"$DIR/out" 2>&1 || complain "dead: $(cat "$DIR/out")"
is '[.instances[0].instead, .plants.dead.library]' '[{"dead":{"status":["Dead"]}},"dead"]'
is '.plants."picea spruce".base' 0.5
"$PACK" make --draft "$DIR/my/scene.json" -o "$DIR/my.eco" >"$DIR/out" 2>&1 && grep -q '10  another plant: "instead" by "status"' "$DIR/out" ||
	complain "dead: $(cat "$DIR/out")"

# ---- A variant that cannot be read is told at once ----
mkdir "$DIR/variants"
cp "$DIR/models/stieleiche.obj" "$DIR/variants/oak_1.obj"
printf 'glTF' >"$DIR/variants/oak_2.glb"
"$PACK" start "$DIR/de.csv" "$DIR/variants" -o "$DIR/none" >"$DIR/out" 2>&1 && complain "a broken variant: $(cat "$DIR/out")"
tr -s '\n ' ' ' <"$DIR/out" | grep -q 'variants/oak_2.glb: .*; or move it out of .*variants: another model will stand for its species' ||
	complain "a broken variant: $(cat "$DIR/out")"
[ -e "$DIR/none" ] && complain "a broken variant: a scene is left"

# ---- A tree that its format lays down, as its exporter left z up, is stood up; one that stands is not ----
# tree UP: a stem and a crown of leaves, z up, in a format that says so, or not
tree() {
	awk -v up="$1" 'BEGIN {
		for (i = 0; i < 12; i++) at = at sprintf("%g %g %g ", .1 * cos(i % 6 * 1.047), .1 * sin(i % 6 * 1.047), i < 6 ? 0 : 3)
		for (i = 0; i < 6; i++) p = p sprintf("%d %d %d %d %d %d ", i, (i + 1) % 6, i + 6, (i + 1) % 6, (i + 1) % 6 + 6, i + 6)
		for (i = 0; i < 300; i++) {
			a = i * 2.4; h = (i * .618034) % 1; r = 1.8 * sqrt(i / 300) * sqrt(h * (1 - h)) * 2; x = r * cos(a); y = r * sin(a); z = 2.5 + 4 * h
			at = at sprintf("%g %g %g %g %g %g %g %g %g ", x, y, z, x + .3 * sin(i), y + .3 * cos(i), z, x, y, z + .3)
			p = p sprintf("%d %d %d ", 12 + 3 * i, 13 + 3 * i, 14 + 3 * i)
		}
		print "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\"><asset><unit meter=\"1\"/><up_axis>" up "</up_axis></asset>"
		print "<library_geometries><geometry id=\"g\"><mesh><source id=\"s\"><float_array id=\"a\" count=\"" 3 * 912 "\">" at "</float_array>"
		print "<technique_common><accessor source=\"#a\" count=\"912\" stride=\"3\"><param name=\"X\" type=\"float\"/>"
		print "<param name=\"Y\" type=\"float\"/><param name=\"Z\" type=\"float\"/></accessor></technique_common></source>"
		print "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#s\"/></vertices><triangles count=\"312\">"
		print "<input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/><p>" p "</p></triangles></mesh></geometry></library_geometries>"
		print "<library_visual_scenes><visual_scene id=\"w\"><node><instance_geometry url=\"#g\"/></node></visual_scene></library_visual_scenes>"
		print "<scene><instance_visual_scene url=\"#w\"/></scene></COLLADA>" }' >"$DIR/stand/oak.dae"
	rm -rf "$DIR/my"
	"$PACK" start "$DIR/zone.csv" "$DIR/stand" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1 || complain "stand $1: $(cat "$DIR/out")"
}
mkdir "$DIR/stand"
tree Y_UP
is .plants.oak.up '"z"'
tr -s '\n ' ' ' <"$DIR/out" | grep -q 'stand of a model in oak z points up .so it stands by its shape; as its format says, with y up, it would lie' ||
	complain "a tree that lies: $(cat "$DIR/out")"
tree Z_UP
is .plants.oak.up null
rm "$DIR/stand/oak.dae"
printf 'v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0.2\nf 1 2 3\nf 1 3 4\n' >"$DIR/stand/oak.obj"
rm -rf "$DIR/my"
"$PACK" start "$DIR/zone.csv" "$DIR/stand" -o "$DIR/my" --crs EPSG:25832 >"$DIR/out" 2>&1
tr -s '\n ' ' ' <"$DIR/out" | grep -q 'stand of a model in oak y points up .its file does not say so, its shape hardly tells' ||
	complain "a sheet: $(cat "$DIR/out")"

# ---- Genus, epithet and cultivar in columns of their own; a status; a crown; a year of planting ----
printf 'Gattung;Art;Sorte;Zustand;Kronendurchmesser (m);Pflanzjahr;lon;lat\nQuercus;robur;;vital;9;1950;11.5;48.1\n' >"$DIR/joined.csv"
printf 'Quercus;robur;Fastigiata;vital;3;;11.501;48.1\nPicea;abies;;gef\303\244llt;4;1990;11.502;48.1\n' >>"$DIR/joined.csv"
start 0 '1 row where "Zustand" is' joined.csv
is '.instances[0] | [.species, .skip.Zustand]' '[["Gattung","Art","Sorte"],["gefällt"]]'
is '.instances[0].crown_m | [.column, .is, .unit, .otherwise]' '["Kronendurchmesser (m)","diameter","m","species"]'
is '.instances[0].height_m[0] | [.from_year, .by]' '["Pflanzjahr","species"]'

# ---- Codes of forestry; an unknown name whose form stands beside it ----
printf '%s\n' 'drevina,vyska_m,lon,lat' 'SM,20,14.4,50.1' 'BK,22,14.401,50.1' 'DBZ,18,14.402,50.1' 'BO,17,14.403,50.1' >"$DIR/codes.csv"
start 0 '4 are codes of cz .as most rows have: SM: picea abies' codes.csv
is '[.instances[0].codes, .instances[0].map.SM]' '["cz","norway_spruce"]'
printf '%s\n' 'species,tree type,lon,lat' 'Zzyzx plonk,Conifer,11.5,48.1' 'Quercus alba,Broadleaf,11.501,48.1' >"$DIR/beside.csv"
start 0 'this one has their form.*Zzyzx plonk' beside.csv
is '.instances[0].map | [."Zzyzx plonk", ."Quercus alba"]' '["norway_spruce","stieleiche"]'

# ---- The place of another scene ----
rm -rf "$DIR/first"
"$PACK" start "$DIR/beside.csv" "$DIR/models" -o "$DIR/first" >/dev/null 2>&1
printf '%s\n' 'species,lon,lat' 'oak,11.51,48.105' >"$DIR/later.csv"
start 0 '.' later.csv --same-place-as "$DIR/first/scene.json"
[ "$(jq -c '[.crs, .origin]' "$DIR/first/scene.json")" = "$(jq -c '[.crs, .origin]' "$DIR/my/scene.json")" ] || complain 'another place'
[ "$(jq -cS . "$DIR/first/camera.json")" = "$(jq -cS . "$DIR/my/camera.json")" ] || complain 'another camera'

exit $failed
