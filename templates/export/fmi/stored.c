/* SPDX-License-Identifier: 0BSD -- see stored.h. */

#include "stored.h"

#include <stdlib.h>
#include <string.h>

static const int ORDER = 0x01020304; /* of the bytes of a number on this machine */
enum { HEADER = 64 };

size_t fmu_state_size(const fmu_instance *fmu)
{
    return HEADER + (size_t) fmu->count * sizeof(double);
}

static void write_header(const fmu_instance *fmu, unsigned char *bytes)
{
    memset(bytes, 0, HEADER);
    memcpy(bytes, &ORDER, sizeof ORDER);
    memcpy(bytes + sizeof ORDER, &fmu->count, sizeof fmu->count);
    memcpy(bytes + 8, fmu_token, strlen(fmu_token));
}

/* Whether there is memory for a state */
static int allocated(fmu_instance *fmu, void **stored)
{
    if (*stored == NULL) {
        *stored = malloc(fmu_state_size(fmu));
    }
    return *stored != NULL;
}

fmu_status fmu_get_state(fmu_instance *fmu, void **stored)
{
    if (!allocated(fmu, stored)) {
        return fmu_fail(fmu, FMU_ERROR, "there is no memory for a state");
    }
    write_header(fmu, (unsigned char *) *stored);
    memcpy((unsigned char *) *stored + HEADER, fmu->state, (size_t) fmu->count * sizeof(double));
    return FMU_OK;
}

fmu_status fmu_set_state(fmu_instance *fmu, const void *stored)
{
    unsigned char header[HEADER];
    double mode;

    write_header(fmu, header);
    if (stored == NULL || memcmp(stored, header, HEADER) != 0) {
        return fmu_fail(fmu, FMU_ERROR, "this is a state of another unit, of another version of it, or of another machine");
    }
    memcpy(&mode, (const unsigned char *) stored + HEADER + FMU_MODE * sizeof mode, sizeof mode);
    if (fmu->exchange ? mode == FMU_BETWEEN_STEPS : mode == FMU_EVENT || mode == FMU_CONTINUOUS) {
        return fmu_fail(fmu, FMU_ERROR, "a state of model exchange is none of co-simulation");
    }
    memcpy(fmu->state, (const unsigned char *) stored + HEADER, (size_t) fmu->count * sizeof(double));
    fmu->set_up = fmu->evaluated = 0;
    return FMU_OK;
}

fmu_status fmu_free_state(void **stored)
{
    if (stored != NULL) {
        free(*stored);
        *stored = NULL;
    }
    return FMU_OK;
}

fmu_status fmu_serialise(fmu_instance *fmu, const void *stored, unsigned char *bytes, size_t size)
{
    if (stored == NULL || size < fmu_state_size(fmu)) {
        return fmu_fail(fmu, FMU_ERROR, "there is no state, or no space for its bytes");
    }
    memcpy(bytes, stored, fmu_state_size(fmu));
    return FMU_OK;
}

fmu_status fmu_deserialise(fmu_instance *fmu, const unsigned char *bytes, size_t size, void **stored)
{
    if (size != fmu_state_size(fmu)) {
        return fmu_fail(fmu, FMU_ERROR, "these are not the bytes of a state of this unit");
    }
    if (!allocated(fmu, stored)) {
        return fmu_fail(fmu, FMU_ERROR, "there is no memory for a state");
    }
    memcpy(*stored, bytes, size); /* what they are is checked where the state is set */
    return FMU_OK;
}
