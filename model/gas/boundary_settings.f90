!> A &boundary record: a named part of the domain's surface and what happens there.
module boundary_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use text, only: word_length
  implicit none
  private
  public :: boundary_settings_t, declare_boundary

  !> The part of the domain's surface inside the box lower..upper. Faces no record names are no-slip walls.
  type :: boundary_settings_t
    character(len=word_length) :: id = ''
    real(wp) :: lower(3) = unset                     !< lowest corner of the box [m]
    real(wp) :: upper(3) = unset                     !< highest corner of the box [m]
    character(len=word_length) :: kind = ''          !< 'inflow' | 'outflow' | 'no_slip' | 'slip'
    real(wp) :: velocity = unset                     !< inflow: superficial, into the domain [m/s]
    real(wp) :: mass_flow = unset                    !< inflow, instead of velocity: over the region [kg/s]
    real(wp) :: pressure = unset                     !< outflow [Pa]; unset: that of the gas
    character(len=word_length) :: parcels = 'wall'   !< 'wall': parcels bounce | 'open': they leave
    character(len=word_length) :: material_id = ''   !< key material: of the wall
    integer :: material = 0                          !< place of that record; 0: that of all walls
  end type boundary_settings_t

contains

  !> The keys of the open record.
  subroutine declare_boundary(settings, keys)
    type(boundary_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get_id(settings%id, 'name of the region')
    call keys%get('lower', settings%lower, 'lowest corner of a box: the region is the part of the domain''s surface inside [m]', &
                  required=.true., when='always')
    call keys%get('upper', settings%upper, 'highest corner of the box [m]', required=.true., when='always')
    call keys%get('kind', settings%kind, 'what the gas does there; no_slip where no region is', &
                  'inflow | outflow | no_slip | slip', required=keys%has_group('gas'), when='with &gas')
    call keys%get('velocity', settings%velocity, 'inflow: superficial velocity into the domain [m/s]', '[0, inf)')
    call keys%get('mass_flow', settings%mass_flow, 'inflow, instead of velocity: mass flow over the region [kg/s]', '[0, inf)')
    call keys%get('pressure', settings%pressure, 'outflow: pressure there; that of &gas if not given [Pa]')
    call keys%get('parcels', settings%parcels, 'whether parcels bounce off the region or leave through it', 'wall | open')
    call keys%get_optional_reference('material', settings%material_id, settings%material, 'material', &
                                     'of a whole face: what it is made of, a &material; wall_material of &contact if not given')
    call check_boundary(settings, keys)
  end subroutine declare_boundary

  !> Each kind has its own keys.
  subroutine check_boundary(settings, keys)
    type(boundary_settings_t), intent(in) :: settings
    type(keys_t), intent(inout) :: keys

    integer :: speeds

    if (all(is_set([settings%lower, settings%upper]))) then
      call keys%require(all(settings%upper >= settings%lower), 'upper', 'must not be below lower in x, y or z')
    end if
    call keys%require(settings%parcels /= 'open' .or. .not. keys%given('material'), 'material', &
                      'parcels leave there and touch nothing')
    if (len_trim(settings%kind) == 0) return
    speeds = count([keys%given('velocity'), keys%given('mass_flow')])
    if (settings%kind == 'inflow') then
      call keys%require(speeds == 1, 'kind', 'give either velocity or mass_flow')
    else
      call keys%require(.not. keys%given('velocity'), 'velocity', 'belongs to an inflow')
      call keys%require(.not. keys%given('mass_flow'), 'mass_flow', 'belongs to an inflow')
    end if
    call keys%require(settings%kind == 'outflow' .or. .not. keys%given('pressure'), 'pressure', 'belongs to an outflow')
  end subroutine check_boundary

end module boundary_settings
