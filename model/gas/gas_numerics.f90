!> The keys of &numerics that belong to the gas.
module gas_numerics
  use case_keys, only: keys_t
  use constants, only: is_set, unset
  use kinds, only: wp
  use text, only: brief, shown, word_length
  implicit none
  private
  public :: gas_numerics_t, declare_gas_numerics, most_halvings

  integer, parameter :: most_halvings = 20  !< of a step, that anyone may ask for

  type :: gas_numerics_t
    real(wp) :: time_step = 1.0e-3_wp               !< longest gas step [s]
    real(wp) :: minimum_time_step = unset           !< shortest one, unset: by maximum_halvings [s]
    real(wp) :: maximum_courant = unset             !< largest |u| dt/h that steps are chosen for, unset: any
    integer :: target_iterations = 0                !< SIMPLE iterations above which steps are shortened, 0: any
    real(wp) :: tolerance = 1.0e-6_wp               !< mass imbalance of a step over the inflow [-]
    real(wp) :: velocity_tolerance = 1.0e-4_wp      !< momentum imbalance of a step over its forces [-]
    integer :: maximum_iterations = 50              !< SIMPLE iterations of a step
    integer :: maximum_halvings = 6                 !< how often a step that fails is halved
    character(len=word_length) :: limiter = 'van_leer'  !< 'van_leer' | 'minmod' | 'superbee' | 'upwind' | 'central' | 'quick'
  end type gas_numerics_t

contains

  !> The keys of the open group.
  subroutine declare_gas_numerics(settings, keys)
    type(gas_numerics_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('time_step', settings%time_step, &
                  'step of the gas, the longest where it adapts (MFIX: DT_MAX, OpenFOAM: maxDeltaT), and of the output; '// &
                  'steps of the parcels divide it [s]', '(0, inf)')
    call keys%get('minimum_time_step', settings%minimum_time_step, 'instead of maximum_halvings: the gas step is '// &
                  'time_step/2**n, and never shorter than this (MFIX: DT_MIN) [s]', '(0, inf)')
    call keys%get('maximum_courant', settings%maximum_courant, 'the next gas step is such that the largest Courant '// &
                  'number of the gas stays below this (OpenFOAM: adjustTimeStep, maxCo); not given: any [-]', '(0, inf)')
    call keys%get('target_iterations', settings%target_iterations, 'after a gas step of more SIMPLE iterations the next '// &
                  'has half its length, after ten of no more twice (MFIX: DT_FAC, here 2); 0: any number', '[0, 10000]')
    call keys%get('tolerance', settings%tolerance, 'gas mass imbalance of a step over its inflow [-]', '(0, 0.1]')
    call keys%get('velocity_tolerance', settings%velocity_tolerance, &
                  'sum of the momentum imbalances of a gas step over that of the forces [-]', '(0, 0.1]')
    call keys%get('maximum_iterations', settings%maximum_iterations, 'SIMPLE iterations of a gas step', '[1, 10000]')
    call keys%get('maximum_halvings', settings%maximum_halvings, &
                  'how often a gas step that does not converge is halved', '[0, 20]')
    call keys%get('limiter', settings%limiter, 'flux limiter of the convection; central and quick are not bounded and '// &
                  'for smooth flow', 'van_leer | minmod | superbee | upwind | central | quick')
    call check_steps(settings, keys)
  end subroutine declare_gas_numerics

  !> The keys of the step fit together.
  subroutine check_steps(settings, keys)
    type(gas_numerics_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    associate (step => settings%time_step, shortest => settings%minimum_time_step)
      if (is_set(shortest)) then
        call keys%require(shortest <= step, 'minimum_time_step', 'is more than time_step, '//shown(step)//' s')
        call keys%require(shortest >= step/2**most_halvings, 'minimum_time_step', 'is less than time_step/2**' &
                          //shown(most_halvings)//', '//brief(step/2**most_halvings)//' s')
        call keys%require(.not. keys%given('maximum_halvings'), 'minimum_time_step', &
                          'says what maximum_halvings says: give one of them')
      end if
    end associate
    call keys%require(settings%target_iterations <= settings%maximum_iterations, 'target_iterations', &
                      'is more than maximum_iterations, '//shown(settings%maximum_iterations)//': such steps fail')
  end subroutine check_steps

end module gas_numerics
