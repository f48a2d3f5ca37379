!> The keys of &numerics that belong to the gas.
module gas_numerics
  use case_keys, only: keys_t
  use kinds, only: wp
  use text, only: word_length
  implicit none
  private
  public :: gas_numerics_t, declare_gas_numerics

  type :: gas_numerics_t
    real(wp) :: time_step = 1.0e-3_wp               !< gas step [s]
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
                  'step of the gas, and of the output; steps of the parcels divide it [s]', '(0, inf)')
    call keys%get('tolerance', settings%tolerance, 'gas mass imbalance of a step over its inflow [-]', '(0, 0.1]')
    call keys%get('velocity_tolerance', settings%velocity_tolerance, &
                  'sum of the momentum imbalances of a gas step over that of the forces [-]', '(0, 0.1]')
    call keys%get('maximum_iterations', settings%maximum_iterations, 'SIMPLE iterations of a gas step', '[1, 10000]')
    call keys%get('maximum_halvings', settings%maximum_halvings, &
                  'how often a gas step that does not converge is halved', '[0, 20]')
    call keys%get('limiter', settings%limiter, 'flux limiter of the convection; central and quick are not bounded and '// &
                  'for smooth flow', 'van_leer | minmod | superbee | upwind | central | quick')
  end subroutine declare_gas_numerics

end module gas_numerics
