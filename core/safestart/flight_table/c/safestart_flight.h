/* Verdicts on starts at rest, from tables that safestart export-c wrote.
 *
 * C99. No allocation, no recursion, no state, no library call but sqrt; every loop has a constant bound. Positions are
 * body-frame metres: x to the side, y along the corridor, z out of the orbit plane. Rounding goes outward: whatever the
 * precision, GO is said only where safestart says GO, NO_GO only where it says NO_GO.
 */
#ifndef SAFESTART_FLIGHT_H
#define SAFESTART_FLIGHT_H

#include "safestart_table.h"

/* All-zero memory is UNDECIDED. */
enum { SS_UNDECIDED = 0, SS_GO = 1, SS_NO_GO = 2 };

/* margin, m: of a GO the proved least distance to every face; of a NO_GO the negative bound; else 0. */
typedef struct {
    int verdict;
    ss_real margin;
} ss_answer;

/* Operating point i, 0 <= i < SS_POINTS; a null pointer for any other i, about which every call below is UNDECIDED. */
const ss_point *ss_point_of(int i);

/* Certificate in closed form (theory/certified.md): GO holds for ever. Start in the orbit plane, or in space. */
ss_answer ss_certify(const ss_point *point, ss_real x, ss_real y);
ss_answer ss_certify_in_space(const ss_point *point, ss_real x, ss_real y, ss_real z);

/* Atlas (theory/atlas.md): starts at rest in LVLH in the orbit plane, staying for SS_STEPS intervals of SS_DT_S. */
ss_answer ss_atlas(const ss_point *point, ss_real x, ss_real y);

/* The certificate's GO, else the atlas's answer. */
ss_answer ss_may_start(const ss_point *point, ss_real x, ss_real y);

/* The proof checker's inequalities on a thrust history (theory/exact.md): pairs (x, y), LVLH, m/s^2, each held for
 * SS_DT_S, from rest in LVLH at (x, y). GO where every thrust is within the chaser's and every face keeps a distance of more
 * than 0 at all times; else UNDECIDED: that this thrust leaves the corridor does not say that every other does. */
ss_answer ss_check_thrust(const ss_point *point, ss_real x, ss_real y, const ss_real thrust[2 * SS_STEPS]);

#endif
