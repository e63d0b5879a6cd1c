/* The vectors beside the table: exit code 0 where every verdict is as safe as safestart's, and equal where it is clear. */
#include "safestart_flight.h"
#include "safestart_vectors.h"

#include <stdio.h>

/* 1 where the verdict claims what safestart's does not, or differs where it must not. */
static int wrong(int got, int wanted, int clear)
{
    return (got != SS_UNDECIDED && got != wanted) || (clear && got != wanted);
}

int main(void)
{
    int failed = 0;
    for (int i = 0; i < SS_VECTORS; i++) {
        const ss_vector *v = &ss_vectors[i];
        const ss_point *point = ss_point_of(v->point);
        failed += wrong(ss_certify(point, v->x, v->y).verdict, v->certified, v->clear_certified);
        failed += wrong(ss_atlas(point, v->x, v->y).verdict, v->atlas, v->clear_atlas);
        failed += wrong(ss_certify_in_space(point, v->x, v->y, v->z).verdict, v->in_space, v->clear_in_space);
    }
    failed += ss_point_of(-1) != (const ss_point *)0 || ss_point_of(SS_POINTS) != (const ss_point *)0;
    printf("safestart flight table %s: %d points, %u bytes of tables, %d vectors, %d wrong\n", SS_TABLE_SHA256, SS_POINTS,
        (unsigned)sizeof ss_points, SS_VECTORS, failed);
    return failed != 0;
}
