#!/usr/bin/env bash
# Makes every octree that a set of render scripts asks for twice, with real oconv and with ours, and compares the bytes,
# the messages and the exit status.
#
# usage: AMBIT_SCENES=FOLDER OURS=path/to/oconv [REAL=oconv] tests/conformance/oconv_identity.sh
#   AMBIT_SCENES  folder with scenes, each with a render.sh that takes OUT, OCONV, RPICT and RTRACE from its environment
#   OURS          our oconv
#   REAL          Radiance's oconv, on PATH by default
set -uo pipefail
: "${AMBIT_SCENES:?folder of scenes}" "${OURS:?path of our oconv}"
export OURS REAL=${REAL:-$(command -v oconv)} WORK
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT

# Stands for oconv in the scripts: runs both, notes what differs, and passes on what the real one made.
cat > "$WORK/both" <<'END'
#!/usr/bin/env bash
part=$(mktemp -d "$WORK/run.XXXXXX")
input=/dev/null
for word in "$@"; do
	if [ "$word" = - ]; then input=$part/input; cat > "$input"; fi
done
(exec -a oconv "$REAL" "$@") > "$part/real" 2> "$part/real.err" < "$input"; real=$?
(exec -a oconv "$OURS" "$@") > "$part/ours" 2> "$part/ours.err" < "$input"; ours=$?
verdict=identical
cmp -s "$part/real" "$part/ours" || verdict=bytes
[ $real -eq $ours ] || verdict=status
# The first lines; ours says below them where in the scene the reason is.
cmp -s <(sort "$part/real.err") <(grep -v '^oconv: at ' "$part/ours.err" | sort) || verdict=$verdict,messages
# Of a failed run real oconv leaves the header, ours nothing.
[ $real -ne 0 ] && [ $real -eq $ours ] && [ ! -s "$part/ours" ] && verdict=${verdict/bytes/identical}
printf '%s\t%s\t%s bytes\toconv %s\n' "$verdict" "$SCENE" "$(wc -c < "$part/real")" "$*" >> "$WORK/verdicts"
cat "$part/real"
cat "$part/real.err" >&2
exit $real
END
chmod +x "$WORK/both"
printf '#!/bin/sh\nexit 0\n' > "$WORK/nothing"
chmod +x "$WORK/nothing"
: > "$WORK/verdicts"

while IFS= read -r script; do
	SCENE=$(basename "$(dirname "$script")")
	export SCENE
	mkdir -p "$WORK/out/$SCENE"
	OUT=$WORK/out/$SCENE OCONV=$WORK/both RPICT=$WORK/nothing RTRACE=$WORK/nothing \
		timeout 600 bash "$script" > "$WORK/out/$SCENE/log" 2>&1
done < <(find "$AMBIT_SCENES" -name render.sh | sort)

cut -c1-160 "$WORK/verdicts"
total=$(wc -l < "$WORK/verdicts")
same=$(grep -c '^identical	' "$WORK/verdicts")
echo "$same of $total octrees identical"
[ "$total" -gt 0 ] && [ "$same" -eq "$total" ]
