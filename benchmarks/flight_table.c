/* Starts (x, y, z) from standard input through every call, verdicts to standard output; for tests and benchmarks.
 * ask POINT: three verdicts a start. ask POINT thrust: after (x, y, z) comes a thrust history; the verdict's margin. */
#include "safestart_flight.h"

#include <stdio.h>
#include <stdlib.h>

int main(int count, char **arguments)
{
    const ss_point *point = count > 1 ? ss_point_of(atoi(arguments[1])) : (const ss_point *)0;
    ss_real start[3], thrust[2 * SS_STEPS];
    if (point == (const ss_point *)0) {
        return 2;
    }
    while (fread(start, sizeof start, 1, stdin) == 1) {
        if (count > 2) {
            if (fread(thrust, sizeof thrust, 1, stdin) != 1) {
                return 2;
            }
            const ss_answer answer = ss_check_thrust(point, start[0], start[1], thrust);
            const double margin = answer.verdict == SS_GO ? (double)answer.margin : -1.0;
            (void)fwrite(&margin, sizeof margin, 1, stdout);
        } else {
            const ss_answer all[4] = {ss_certify(point, start[0], start[1]), ss_atlas(point, start[0], start[1]),
                ss_certify_in_space(point, start[0], start[1], start[2]), ss_may_start(point, start[0], start[1])};
            for (int i = 0; i < 4; i++) {
                const double said[2] = {(double)all[i].verdict, (double)all[i].margin};
                (void)fwrite(said, sizeof said, 1, stdout);
            }
        }
    }
    return 0;
}
