/* Prints what a compiler reads of an exported header: the period in ns, then every code. */
#include <stdio.h>
#include "cooling_step.h"

int main(void) {
    printf("%lu\n", (unsigned long)cooling_step_period_ns);
    for (uint32_t k = 0; k < cooling_step_count; k++) printf("%d\n", cooling_step_wave[k]);
    return 0;
}
