!> The &contact group: springs, dashpots and friction between parcels, and against walls; and the materials that depart from it.
module contact_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use material_settings, only: material_settings_t, pair_settings_t
  use text, only: word_length
  implicit none
  private
  public :: contact_settings_t, declare_contact

  type :: contact_settings_t
    character(len=word_length) :: law = 'linear'      !< or 'hertz'
    real(wp) :: stiffness = unset                     !< linear: normal, k_n [N/m]
    real(wp) :: youngs_modulus = unset                !< hertz: of the parcels' material [Pa]
    real(wp) :: poisson_ratio = unset                 !< hertz: of the parcels' material [-]
    real(wp) :: wall_youngs_modulus = unset           !< hertz: of the walls [Pa]; unset: as parcels
    real(wp) :: wall_poisson_ratio = unset            !< hertz: of the walls [-]; unset: as parcels
    real(wp) :: impact_velocity = 1.0_wp              !< hertz: of the impacts that set the solids step [m/s]
    real(wp) :: tangential_ratio = 2.0_wp/7.0_wp      !< k_t/k_n [-]
    real(wp) :: restitution = 0.9_wp                  !< normal, e_n [-]
    real(wp) :: friction = 0.0_wp                     !< Coulomb, mu [-]; 0: none, and no rotation
    real(wp) :: tangential_damping_ratio = 0.5_wp     !< gamma_t/gamma_n [-]
    real(wp) :: wall_stiffness = unset                !< k_n against walls [N/m]; unset: as parcels
    real(wp) :: wall_restitution = unset              !< e_n against walls [-]; unset: as parcels
    real(wp) :: wall_friction = unset                 !< mu against walls [-]; unset: as parcels
    character(len=word_length) :: rolling = 'none'    !< or 'constant_torque', 'spring': see rolling
    real(wp) :: rolling_friction = unset              !< mu_r [-]
    real(wp) :: rolling_damping = 0.3_wp              !< spring: of its critical damping, eta [-]
    real(wp) :: wall_rolling_friction = unset         !< mu_r against walls [-]; unset: as parcels
    character(len=word_length) :: cohesion = 'none'   !< or 'van_der_waals', 'linear': see cohesion
    real(wp) :: hamaker_constant = unset              !< A [J]
    real(wp) :: wall_hamaker_constant = unset         !< A of parcel and wall [J]; unset: as parcels
    real(wp) :: minimum_separation = unset            !< h_min [m]
    real(wp) :: maximum_separation = unset            !< h_max [m]
    real(wp) :: cohesion_energy = unset               !< k [J/m3]
    real(wp) :: wall_cohesion_energy = unset          !< k of parcel and wall [J/m3]; unset: as parcels
    character(len=word_length) :: cohesion_scaling = 'none'     !< or 'bond_number': see coarse_graining
    character(len=word_length) :: stiffness_scaling = 'none'    !< or 'constant_modulus': see coarse_graining
    character(len=word_length) :: restitution_scaling = 'none'  !< or 'dissipation'
    real(wp) :: coarseness = unset                    !< with scaling: width of a parcel over its particle's [-]
    character(len=word_length) :: wall_material_id = ''  !< key wall_material: of the faces, and of walls that name none
    integer :: wall_material = 0                      !< its place in `materials`; 0: none, as above
    type(material_settings_t), allocatable :: materials(:)  !< exist if there are any
    type(pair_settings_t), allocatable :: pairs(:)          !< exist with materials
    integer, allocatable :: powder_material(:)              !< of each powder; 0: none, as above. Exists with materials
    integer, allocatable :: own_material(:)                 !< of walls and faces that name one; 0: none. Exists with materials
  contains
    procedure :: must_give
  end type contact_settings_t

contains

  !> The keys of the open group.
  subroutine declare_contact(settings, keys)
    type(contact_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: hertz

    call keys%get('law', settings%law, 'linear: spring and dashpot; hertz: Hertz and Mindlin', 'linear | hertz')
    hertz = settings%law == 'hertz'
    call declare_wall_material(settings, keys)
    call keys%get('stiffness', settings%stiffness, 'normal spring between parcels, k_n [N/m]', '(0, inf)', &
                  required=settings%must_give('stiffness') .and. .not. hertz, when='for linear, unless all materials give it')
    call declare_hertz(settings, hertz, keys)
    call keys%get('tangential_ratio', settings%tangential_ratio, 'linear: tangential over normal stiffness [-]', '(0, 2]')
    call keys%get('restitution', settings%restitution, 'normal restitution, e_n [-]', '[0.01, 1]')
    call keys%get('friction', settings%friction, 'Coulomb friction, mu; 0: no tangential force, no rotation [-]', '[0, 10]')
    call keys%get('tangential_damping_ratio', settings%tangential_damping_ratio, 'tangential over normal damping [-]', '[0, 2]')
    call keys%get('wall_stiffness', settings%wall_stiffness, 'linear: the same against walls; as parcels if not given [N/m]', &
                  '(0, inf)')
    call keys%get('wall_restitution', settings%wall_restitution, 'the same against walls; as parcels if not given [-]', '[0.01, 1]')
    call keys%get('wall_friction', settings%wall_friction, 'the same against walls; as parcels if not given [-]', '[0, 10]')
    call declare_rolling(settings, keys)
    call declare_cohesion(settings, keys)
    call keys%get('stiffness_scaling', settings%stiffness_scaling, 'stiffness of parcels: none: as given; '// &
                  'constant_modulus: as given times their width over that of their particles', 'none | constant_modulus')
    call keys%get('restitution_scaling', settings%restitution_scaling, 'restitution of parcels: none: as given; '// &
                  'dissipation: less, so that they dissipate as their particles do', 'none | dissipation')
    if (allocated(settings%materials) .or. .not. is_set(settings%wall_friction)) return
    call keys%require(settings%friction > 0 .or. .not. settings%wall_friction > 0, 'wall_friction', &
                      'needs friction between parcels, too: parcels without friction do not rotate')
  end subroutine declare_contact

  !> Keys of the resistance to rolling.
  subroutine declare_rolling(settings, keys)
    type(contact_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: on

    call keys%get('rolling', settings%rolling, 'resistance to rolling: a constant torque against it, or a spring with a limit', &
                  'none | constant_torque | spring')
    on = settings%rolling == 'constant_torque' .or. settings%rolling == 'spring'
    call keys%get('rolling_friction', settings%rolling_friction, 'largest rolling torque over normal force and '// &
                  'r_i r_j/(r_i + r_j), mu_r [-]', '(0, 10]', required=on .and. settings%must_give('rolling_friction'), &
                  when='with rolling, unless all materials give it')
    call keys%get('rolling_damping', settings%rolling_damping, 'spring: its damping over the critical one [-]', '[0, 1]')
    call keys%get('wall_rolling_friction', settings%wall_rolling_friction, 'mu_r against walls; as parcels if not given [-]', &
                  '[0, 10]')
    call keys%require(settings%friction > 0 .or. allocated(settings%materials) .or. .not. on, 'rolling', &
                      'needs friction: parcels without it do not rotate')
    call keys%require(on .or. settings%rolling /= 'none' .or. .not. is_set(settings%rolling_friction), 'rolling_friction', &
                      'belongs to rolling = ''constant_torque'' or ''spring''')
  end subroutine declare_rolling

  !> Keys of the attraction.
  subroutine declare_cohesion(settings, keys)
    type(contact_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    logical :: van_der_waals, linear

    call keys%get('cohesion', settings%cohesion, 'attraction: van der Waals'', between near surfaces; linear: by area of '// &
                  'contact', 'none | van_der_waals | linear')
    van_der_waals = settings%cohesion == 'van_der_waals'
    linear = settings%cohesion == 'linear'
    call keys%get('hamaker_constant', settings%hamaker_constant, 'van der Waals: Hamaker''s constant [J]', '(0, inf)', &
                  required=van_der_waals .and. settings%must_give('hamaker_constant'), &
                  when='for van_der_waals, unless all materials give it')
    call keys%get('wall_hamaker_constant', settings%wall_hamaker_constant, 'of parcels and walls; as parcels if not given [J]', &
                  '[0, inf)')
    call keys%get('minimum_separation', settings%minimum_separation, 'van der Waals: gap from which on, touching included, '// &
                  'the attraction grows no more [m]', '(0, inf)', required=van_der_waals, when='for van_der_waals')
    call keys%get('maximum_separation', settings%maximum_separation, 'van der Waals: gap from which on there is none [m]', &
                  '(0, inf)', required=van_der_waals, when='for van_der_waals')
    call keys%get('cohesion_energy', settings%cohesion_energy, 'linear: attraction over area of contact [J/m3]', '(0, inf)', &
                  required=linear .and. settings%must_give('cohesion_energy'), when='for linear, unless all materials give it')
    call keys%get('wall_cohesion_energy', settings%wall_cohesion_energy, 'the same against walls; as parcels if not given '// &
                  '[J/m3]', '[0, inf)')
    call keys%get('cohesion_scaling', settings%cohesion_scaling, 'attraction of parcels: none: as given; bond_number: over '// &
                  'their weight as that of their particles', 'none | bond_number')
    call keys%require(.not. linear .or. settings%law == 'hertz', 'cohesion', 'needs law = ''hertz'': beside a linear spring '// &
                      'an attraction by area would be no more than a softer spring')
    call check_cohesion(settings, van_der_waals, linear, keys)
  end subroutine declare_cohesion

  subroutine check_cohesion(settings, van_der_waals, linear, keys)
    type(contact_settings_t), intent(in) :: settings
    logical, intent(in) :: van_der_waals, linear
    type(keys_t), intent(inout) :: keys

    call keys%require(van_der_waals .or. .not. is_set(settings%hamaker_constant), 'hamaker_constant', &
                      'belongs to cohesion = ''van_der_waals''')
    call keys%require(linear .or. .not. is_set(settings%cohesion_energy), 'cohesion_energy', 'belongs to cohesion = ''linear''')
    if (van_der_waals .and. is_set(settings%minimum_separation) .and. is_set(settings%maximum_separation)) then
      call keys%require(settings%maximum_separation > settings%minimum_separation, 'maximum_separation', &
                        'must be more than minimum_separation')
    end if
  end subroutine check_cohesion

  !> The material of walls, which takes the place of what else is said of them.
  subroutine declare_wall_material(settings, keys)
    type(contact_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: own(8) = [character(len=21) :: 'wall_stiffness', 'wall_youngs_modulus', 'wall_poisson_ratio', &
                                             'wall_restitution', 'wall_friction', 'wall_rolling_friction', &
                                             'wall_hamaker_constant', 'wall_cohesion_energy']
    integer :: i

    call keys%get_optional_reference('wall_material', settings%wall_material_id, settings%wall_material, 'material', &
                                     'what faces of the domain, and walls that do not say, are made of, a &material')
    if (.not. keys%given('wall_material')) return
    do i = 1, size(own)
      call keys%require(.not. keys%given(trim(own(i))), trim(own(i)), 'belongs to walls without a material; there are none')
    end do
  end subroutine declare_wall_material

  !> Whether a property is asked of &contact: whether some powder has no material, or one, or a wall one, that does not give it.
  pure function must_give(self, property) result(must)
    class(contact_settings_t), intent(in) :: self
    character(len=*), intent(in) :: property
    logical :: must

    must = .true.
    if (.not. (allocated(self%materials) .and. allocated(self%powder_material))) return
    if (any(self%powder_material == 0)) return
    associate (used => [self%powder_material, self%own_material, self%wall_material])
      must = .not. all(self%materials(pack(used, used > 0))%gives(property))
    end associate
  end function must_give

  !> Keys of the law of Hertz, which may stand where the linear one is chosen, so that one line changes it.
  subroutine declare_hertz(settings, hertz, keys)
    type(contact_settings_t), intent(inout) :: settings
    logical, intent(in) :: hertz
    type(keys_t), intent(inout) :: keys

    character(len=*), parameter :: when = 'for hertz, unless all materials give it'

    call keys%get('youngs_modulus', settings%youngs_modulus, 'Young''s modulus of the parcels'' material [Pa]', '(0, inf)', &
                  required=hertz .and. settings%must_give('youngs_modulus'), when=when)
    call keys%get('poisson_ratio', settings%poisson_ratio, 'Poisson''s ratio of the parcels'' material [-]', '(-1, 0.5)', &
                  required=hertz .and. settings%must_give('poisson_ratio'), when=when)
    call keys%get('wall_youngs_modulus', settings%wall_youngs_modulus, 'hertz: that of the walls, 1e30 for rigid ones; '// &
                  'as parcels if not given [Pa]', '(0, inf)')
    call keys%get('wall_poisson_ratio', settings%wall_poisson_ratio, 'hertz: that of the walls; as parcels if not given [-]', &
                  '(-1, 0.5)')
    call keys%get('impact_velocity', settings%impact_velocity, 'hertz: speed of the impacts that set the solids step; '// &
                  'faster ones shorten it [m/s]', '(0, inf)')
  end subroutine declare_hertz

end module contact_settings
