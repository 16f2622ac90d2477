/*
 * SPDX-License-Identifier: 0BSD
 *
 * What FMI 3.0 has and this unit has not: variables of other types than Float64, dependencies of elements, structural
 * parameters, clocks, scheduled execution, event mode and derivatives of outputs in co-simulation.
 */

#include "component3.h"

static const char NO_SUCH_TYPE[] = "all variables are of the type Float64";

#define NO_VARIABLES(Type)                                                                                            \
    FMI3_EXPORT fmi3Status FMI3(Get##Type)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,                \
                                           fmi3##Type values[], size_t value_count)                                    \
    {                                                                                                                  \
        (void) vr, (void) values, (void) value_count;                                                                  \
        return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);                                                          \
    }                                                                                                                  \
    FMI3_EXPORT fmi3Status FMI3(Set##Type)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,                \
                                           const fmi3##Type values[], size_t value_count)                              \
    {                                                                                                                  \
        (void) vr, (void) values, (void) value_count;                                                                  \
        return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);                                                          \
    }

NO_VARIABLES(Float32)
NO_VARIABLES(Int8)
NO_VARIABLES(UInt8)
NO_VARIABLES(Int16)
NO_VARIABLES(UInt16)
NO_VARIABLES(Int32)
NO_VARIABLES(UInt32)
NO_VARIABLES(Int64)
NO_VARIABLES(UInt64)
NO_VARIABLES(Boolean)
NO_VARIABLES(String)

FMI3_EXPORT fmi3Status FMI3(GetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, size_t sizes[],
                                       fmi3Binary values[], size_t value_count)
{
    (void) vr, (void) sizes, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status FMI3(SetBinary)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const size_t sizes[],
                                       const fmi3Binary values[], size_t value_count)
{
    (void) vr, (void) sizes, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status FMI3(GetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, fmi3Clock values[])
{
    (void) vr, (void) values;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status FMI3(SetClock)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, const fmi3Clock values[])
{
    (void) vr, (void) values;
    return count == 0 ? fmi3OK : refuse(c, NO_SUCH_TYPE);
}

FMI3_EXPORT fmi3Status FMI3(GetNumberOfVariableDependencies)(fmi3Instance c, fmi3ValueReference vr, size_t *count)
{
    (void) vr;
    *count = 0;
    return refuse(c, "the dependencies of elements are not provided");
}

FMI3_EXPORT fmi3Status FMI3(GetVariableDependencies)(fmi3Instance c, fmi3ValueReference dependent, size_t elements[],
                                                     fmi3ValueReference independents[], size_t independent_elements[],
                                                     fmi3DependencyKind kinds[], size_t count)
{
    (void) dependent, (void) elements, (void) independents, (void) independent_elements, (void) kinds, (void) count;
    return refuse(c, "the dependencies of elements are not provided");
}

/* ---- clocks, of which there are none ---- */

static fmi3Status no_clocks(fmi3Instance c, size_t count)
{
    return count == 0 ? fmi3OK : refuse(c, "there are no clocks");
}

FMI3_EXPORT fmi3Status FMI3(GetIntervalDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
{
    (void) vr, (void) intervals, (void) qualifiers;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(GetIntervalFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                 fmi3UInt64 counters[], fmi3UInt64 resolutions[],
                                                 fmi3IntervalQualifier qualifiers[])
{
    (void) vr, (void) counters, (void) resolutions, (void) qualifiers;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(GetShiftDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                             fmi3Float64 shifts[])
{
    (void) vr, (void) shifts;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(GetShiftFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                              fmi3UInt64 counters[], fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(SetIntervalDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                const fmi3Float64 intervals[])
{
    (void) vr, (void) intervals;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(SetIntervalFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                 const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(SetShiftDecimal)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                             const fmi3Float64 shifts[])
{
    (void) vr, (void) shifts;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(SetShiftFraction)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                              const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
{
    (void) vr, (void) counters, (void) resolutions;
    return no_clocks(c, count);
}

FMI3_EXPORT fmi3Status FMI3(ActivateModelPartition)(fmi3Instance c, fmi3ValueReference clock, fmi3Float64 time)
{
    (void) clock, (void) time;
    return no_clocks(c, 1);
}

/* ---- configuration, scheduled execution, events and derivatives of outputs ---- */

FMI3_EXPORT fmi3Status FMI3(EnterConfigurationMode)(fmi3Instance c)
{
    return refuse(c, "there are no structural parameters");
}

FMI3_EXPORT fmi3Status FMI3(ExitConfigurationMode)(fmi3Instance c)
{
    return refuse(c, "there are no structural parameters");
}

FMI3_EXPORT fmi3Instance FMI3(InstantiateScheduledExecution)(
    fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
    fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback clock,
    fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock)
{
    (void) name, (void) token, (void) resources, (void) visible, (void) logging, (void) clock, (void) lock, (void) unlock;
    if (log != NULL) {
        log(environment, fmi3Error, "logStatusError", "this unit has no scheduled execution");
    }
    return NULL;
}

FMI3_EXPORT fmi3Status FMI3(EnterStepMode)(fmi3Instance c)
{
    return refuse(c, "co-simulation has no event mode in this unit");
}

FMI3_EXPORT fmi3Status FMI3(GetEventIndicators)(fmi3Instance c, fmi3Float64 z[], size_t count)
{
    (void) z;
    return count == 0 ? fmi3OK : refuse(c, "there are no event indicators");
}

FMI3_EXPORT fmi3Status FMI3(GetNumberOfEventIndicators)(fmi3Instance c, size_t *count)
{
    (void) c;
    *count = 0;
    return fmi3OK;
}

FMI3_EXPORT fmi3Status FMI3(GetOutputDerivatives)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                                  const fmi3Int32 orders[], fmi3Float64 values[], size_t value_count)
{
    (void) vr, (void) orders, (void) values, (void) value_count;
    return count == 0 ? fmi3OK : refuse(c, "there are no derivatives of outputs");
}
