!> The &coupling group: what gas and parcels do to each other.
module coupling_settings
  use case_keys, only: keys_t
  use kinds, only: wp
  use text, only: word_length
  implicit none
  private
  public :: coupling_settings_t, declare_coupling

  type :: coupling_settings_t
    character(len=word_length) :: drag = 'gidaspow'  !< 'gidaspow' | 'beetstra'
    real(wp) :: minimum_void_fraction = 0.3_wp       !< the gas never sees less [-]
  end type coupling_settings_t

contains

  !> The keys of the open group.
  subroutine declare_coupling(settings, keys)
    type(coupling_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('drag', settings%drag, 'drag law', 'gidaspow | beetstra')
    call keys%get('minimum_void_fraction', settings%minimum_void_fraction, 'the gas never sees less [-]', '[0.05, 0.6]')
  end subroutine declare_coupling

end module coupling_settings
