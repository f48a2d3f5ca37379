!> The keys of &numerics that belong to the parcels.
module des_settings
  use case_keys, only: keys_t
  use constants, only: unset
  use kinds, only: wp
  implicit none
  private
  public :: des_settings_t, declare_des

  type :: des_settings_t
    real(wp) :: steps_per_collision = 20.0_wp  !< solids steps in the shortest collision [-]
    real(wp) :: skin = unset                   !< extra reach of the neighbour list [m]; unset: automatic
  end type des_settings_t

contains

  !> The keys of the open group.
  subroutine declare_des(settings, keys)
    type(des_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('steps_per_collision', settings%steps_per_collision, &
                  'steps of the parcels in the shortest collision [-]', '[5, 1000]')
    call keys%get('skin', settings%skin, 'reach of the neighbour list beyond contact; chosen by the program if not given [m]', &
                  '(0, 1)')
  end subroutine declare_des

end module des_settings
