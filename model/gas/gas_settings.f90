!> The &gas group: the gas and the state it starts from.
module gas_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  implicit none
  private
  public :: gas_settings_t, declare_gas

  type :: gas_settings_t
    logical :: present = .false.         !< whether the case has a &gas group at all
    real(wp) :: density = 1.2_wp         !< [kg/m3]
    real(wp) :: viscosity = 1.8e-5_wp    !< dynamic [Pa s]
    real(wp) :: velocity(3) = 0.0_wp     !< at the start, in the voids [m/s]
    real(wp) :: pressure = 0.0_wp        !< reference, and that of outflows which name none [Pa]
    real(wp) :: pressure_drop(3) = 0.0_wp  !< along periodic directions, over the domain [Pa]
    logical :: flow_given = .false.      !< whether mass_flow is kept along periodic directions
    real(wp) :: mass_flow(3) = unset     !< through the domain along them [kg/s]
  end type gas_settings_t

contains

  !> The keys of the open group.
  subroutine declare_gas(settings, keys)
    type(gas_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    settings%present = keys%has_group('gas')
    call keys%get('density', settings%density, 'density of the gas [kg/m3]', '(0, inf)')
    call keys%get('viscosity', settings%viscosity, 'dynamic viscosity of the gas [Pa s]', '(0, inf)')
    call keys%get('velocity', settings%velocity, 'velocity in the voids at the start [m/s]')
    call keys%get('pressure', settings%pressure, 'reference pressure, and that of outflows that name none [Pa]')
    call keys%get('pressure_drop', settings%pressure_drop, &
                  'by how much the pressure falls across the domain, along periodic directions [Pa]')
    call keys%get('mass_flow', settings%mass_flow, 'instead of pressure_drop: the mass flow that is kept along every '// &
                  'periodic direction by a pressure drop that is found; 0 keeps the gas from flowing through [kg/s]')
    settings%flow_given = all(is_set(settings%mass_flow))
    call keys%require(.not. (settings%flow_given .and. any(abs(settings%pressure_drop) > 0.0_wp)), 'mass_flow', &
                      'give either mass_flow or pressure_drop')
  end subroutine declare_gas

end module gas_settings
