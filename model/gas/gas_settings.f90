!> The &gas group: the gas and the state it starts from.
module gas_settings
  use case_keys, only: keys_t
  use constants, only: gas_constant, unset, is_set
  use kinds, only: wp
  use text, only: shown, word_length
  implicit none
  private
  public :: gas_settings_t, declare_gas, compressibility, make_ideal

  type :: gas_settings_t
    logical :: present = .false.         !< whether the case has a &gas group at all
    character(len=word_length) :: density_law = 'constant'  !< 'constant' | 'ideal'
    real(wp) :: density = 1.2_wp         !< of an ideal gas at `pressure` [kg/m3]
    real(wp) :: molar_mass = unset       !< ideal [kg/mol]
    real(wp) :: temperature = unset      !< ideal [K]
    real(wp) :: reference_pressure = unset  !< ideal: absolute pressure from which all others are counted [Pa]
    real(wp) :: viscosity = 1.8e-5_wp    !< dynamic [Pa s]
    character(len=word_length) :: turbulence_model = 'none'  !< 'none' | 'smagorinsky'
    real(wp) :: smagorinsky_constant = 0.17_wp  !< C_s, with 'smagorinsky' [-]
    real(wp) :: velocity(3) = 0.0_wp     !< at the start, in the voids [m/s]
    real(wp) :: pressure = 0.0_wp        !< at the start, and that of outflows which name none [Pa]
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
    call declare_density(settings, keys)
    call keys%get('viscosity', settings%viscosity, 'dynamic viscosity of the gas [Pa s]', '(0, inf)')
    call declare_turbulence(settings, keys)
    call keys%get('velocity', settings%velocity, 'velocity in the voids at the start [m/s]')
    call keys%get('pressure', settings%pressure, 'pressure at the start, and that of outflows that name none [Pa]')
    call keys%get('pressure_drop', settings%pressure_drop, &
                  'by how much the pressure falls across the domain, along periodic directions [Pa]')
    call keys%get('mass_flow', settings%mass_flow, 'instead of pressure_drop: the mass flow that is kept along every '// &
                  'periodic direction by a pressure drop that is found; 0 keeps the gas from flowing through [kg/s]')
    settings%flow_given = all(is_set(settings%mass_flow))
    call keys%require(.not. (settings%flow_given .and. any(abs(settings%pressure_drop) > 0.0_wp)), 'mass_flow', &
                      'give either mass_flow or pressure_drop')
    call check_ideal(settings, keys)
  end subroutine declare_gas

  !> The eddies that are smaller than the cells.
  subroutine declare_turbulence(settings, keys)
    type(gas_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('turbulence_model', settings%turbulence_model, 'viscosity of eddies smaller than the cells, added to that '// &
                  'of the gas: none, or Smagorinsky''s, rho (C_s Delta)^2 sqrt(2 S:S), with Delta^3 the volume of a cell and S '// &
                  'the rate of strain (MFIX: TURBULENCE_MODEL; OpenFOAM: LESModel Smagorinsky)', 'none | smagorinsky')
    if (settings%turbulence_model /= 'smagorinsky') settings%smagorinsky_constant = unset
    call keys%get('smagorinsky_constant', settings%smagorinsky_constant, 'C_s of smagorinsky, 0.17 if not given, that of '// &
                  'isotropic turbulence (Lilly 1967; OpenFOAM: Ck 0.094 and Ce 1.048 make 0.168); 0.1 in shear flow between '// &
                  'walls (Deardorff 1970) [-]', '(0, 1]')
    call keys%require(settings%turbulence_model == 'smagorinsky' .or. .not. keys%given('smagorinsky_constant'), &
                      'smagorinsky_constant', "belongs to turbulence_model = 'smagorinsky'")
  end subroutine declare_turbulence

  !> The same everywhere, or that of an ideal gas.
  subroutine declare_density(settings, keys)
    type(gas_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: when = "with density_law = 'ideal'"
    logical :: ideal

    call keys%get('density_law', settings%density_law, 'the same density everywhere, or that of an ideal gas of one '// &
                  'temperature, (reference_pressure + p) molar_mass/(R temperature) (MFIX: RO_g0 given or not; OpenFOAM: '// &
                  'rhoConst, perfectGas)', 'constant | ideal')
    ideal = settings%density_law == 'ideal'
    if (ideal) settings%density = unset
    call keys%get('density', settings%density, 'density of the gas, where it is constant (MFIX: RO_g0) [kg/m3]', '(0, inf)')
    call keys%get('molar_mass', settings%molar_mass, 'of an ideal gas; air has 0.02896 (MFIX: MW_g0, in kg/kmol) [kg/mol]', &
                  '(0, 1]', required=ideal, when=when)
    call keys%get('temperature', settings%temperature, 'of an ideal gas (MFIX: T_g0) [K]', '(0, inf)', required=ideal, when=when)
    call keys%get('reference_pressure', settings%reference_pressure, 'of an ideal gas: absolute pressure from which all '// &
                  'pressures of case and results are counted; if not given they are absolute (MFIX: P_ref) [Pa]', '[0, inf)')
    if (ideal .and. .not. is_set(settings%reference_pressure)) settings%reference_pressure = 0.0_wp
  end subroutine declare_density

  !> Either law has its own keys, and an ideal gas needs a pressure.
  subroutine check_ideal(settings, keys)
    type(gas_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: of_ideal(3) = [character(len=18) :: 'molar_mass', 'temperature', 'reference_pressure']
    integer :: i

    if (settings%density_law == 'ideal') then
      call keys%require(.not. keys%given('density'), 'density', 'follows from pressure and temperature of an ideal gas')
      associate (absolute => settings%reference_pressure + settings%pressure)
        call keys%require(absolute > 0.0_wp, 'pressure', 'of an ideal gas, with reference_pressure, must be above 0, not ' &
                          //shown(absolute)//' Pa')
        if (all(is_set([settings%molar_mass, settings%temperature])) .and. absolute > 0.0_wp) call make_ideal(settings)
      end associate
    else
      do i = 1, size(of_ideal)
        call keys%require(.not. keys%given(trim(of_ideal(i))), trim(of_ideal(i)), "belongs to density_law = 'ideal'")
      end do
    end if
  end subroutine check_ideal

  !> Of settings that have all that an ideal gas needs: its density at `pressure`.
  pure subroutine make_ideal(settings)
    type(gas_settings_t), intent(inout) :: settings

    settings%density_law = 'ideal'
    settings%density = compressibility(settings)*(settings%reference_pressure + settings%pressure)
  end subroutine make_ideal

  !> psi = M/(R T), the density of an ideal gas over its absolute pressure [kg/(m3 Pa)].
  pure function compressibility(settings) result(psi)
    type(gas_settings_t), intent(in) :: settings
    real(wp) :: psi

    psi = settings%molar_mass/(gas_constant*settings%temperature)
  end function compressibility

end module gas_settings
