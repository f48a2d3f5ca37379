!> The &contact group: linear springs, dashpots and friction between parcels, and against walls.
module contact_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use text, only: word_length
  implicit none
  private
  public :: contact_settings_t, declare_contact

  type :: contact_settings_t
    real(wp) :: stiffness = unset                     !< normal, k_n [N/m]
    real(wp) :: tangential_ratio = 2.0_wp/7.0_wp      !< k_t/k_n [-]
    real(wp) :: restitution = 0.9_wp                  !< normal, e_n [-]
    real(wp) :: friction = 0.0_wp                     !< Coulomb, mu [-]; 0: none, and no rotation
    real(wp) :: tangential_damping_ratio = 0.5_wp     !< gamma_t/gamma_n [-]
    real(wp) :: wall_stiffness = unset                !< k_n against walls [N/m]; unset: as parcels
    real(wp) :: wall_restitution = unset              !< e_n against walls [-]; unset: as parcels
    real(wp) :: wall_friction = unset                 !< mu against walls [-]; unset: as parcels
    character(len=word_length) :: stiffness_scaling = 'none'    !< or 'constant_modulus': see coarse_graining
    character(len=word_length) :: restitution_scaling = 'none'  !< or 'dissipation'
  end type contact_settings_t

contains

  !> The keys of the open group.
  subroutine declare_contact(settings, keys)
    type(contact_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get('stiffness', settings%stiffness, 'normal spring between parcels, k_n [N/m]', '(0, inf)', &
                  required=.true., when='always')
    call keys%get('tangential_ratio', settings%tangential_ratio, 'tangential over normal stiffness [-]', '(0, 2]')
    call keys%get('restitution', settings%restitution, 'normal restitution, e_n [-]', '[0.01, 1]')
    call keys%get('friction', settings%friction, 'Coulomb friction, mu; 0: no tangential force, no rotation [-]', '[0, 10]')
    call keys%get('tangential_damping_ratio', settings%tangential_damping_ratio, 'tangential over normal damping [-]', '[0, 2]')
    call keys%get('wall_stiffness', settings%wall_stiffness, 'the same against walls; as parcels if not given [N/m]', '(0, inf)')
    call keys%get('wall_restitution', settings%wall_restitution, 'the same against walls; as parcels if not given [-]', '[0.01, 1]')
    call keys%get('wall_friction', settings%wall_friction, 'the same against walls; as parcels if not given [-]', '[0, 10]')
    call keys%get('stiffness_scaling', settings%stiffness_scaling, 'stiffness of parcels: none: as given; '// &
                  'constant_modulus: as given times their width over that of their particles', 'none | constant_modulus')
    call keys%get('restitution_scaling', settings%restitution_scaling, 'restitution of parcels: none: as given; '// &
                  'dissipation: less, so that they dissipate as their particles do', 'none | dissipation')
    if (.not. is_set(settings%wall_friction)) return
    call keys%require(settings%friction > 0 .or. .not. settings%wall_friction > 0, 'wall_friction', &
                      'needs friction between parcels, too: parcels without friction do not rotate')
  end subroutine declare_contact

end module contact_settings
