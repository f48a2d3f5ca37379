!> The &material and &material_pair records: what parcels and walls are made of, and what two materials are to each other.
module material_settings
  use case_keys, only: keys_t
  use constants, only: unset, is_set
  use kinds, only: wp
  use text, only: word_length
  implicit none
  private
  public :: material_settings_t, pair_settings_t, declare_material, declare_pair

  !> What is unset is as in &contact.
  type :: material_settings_t
    character(len=word_length) :: id = ''
    real(wp) :: stiffness = unset         !< linear: k_n of a contact with its like [N/m]
    real(wp) :: youngs_modulus = unset    !< hertz: [Pa]
    real(wp) :: poisson_ratio = unset     !< hertz: [-]
    real(wp) :: restitution = unset       !< e_n of a contact with its like [-]
    real(wp) :: friction = unset          !< mu of a contact with its like [-]
    real(wp) :: rolling_friction = unset  !< mu_r of a contact with its like [-]
    real(wp) :: rolling_damping = unset   !< eta of a contact with its like [-]
    real(wp) :: hamaker_constant = unset  !< A of two of it [J]
    real(wp) :: cohesion_energy = unset   !< k of two of it [J/m3]
  contains
    procedure :: gives
  end type material_settings_t

  !> What is unset follows from the two materials: see contact_pairs.
  type :: pair_settings_t
    character(len=word_length) :: ids(2) = ''      !< of the two materials
    integer :: materials(2) = 0                    !< places of these records
    real(wp) :: stiffness = unset                  !< linear: k_n [N/m]
    real(wp) :: restitution = unset                !< e_n [-]
    real(wp) :: friction = unset                   !< mu [-]
    real(wp) :: tangential_ratio = unset           !< linear: k_t/k_n [-]
    real(wp) :: tangential_damping_ratio = unset   !< gamma_t/gamma_n [-]
    real(wp) :: rolling_friction = unset           !< mu_r [-]
    real(wp) :: rolling_damping = unset            !< eta [-]
    real(wp) :: hamaker_constant = unset           !< A [J]
    real(wp) :: cohesion_energy = unset            !< k [J/m3]
  end type pair_settings_t

contains

  !> The keys of the open record &material.
  subroutine declare_material(settings, keys)
    type(material_settings_t), intent(inout) :: settings
    type(keys_t), intent(inout) :: keys

    call keys%get_id(settings%id, 'name of the material')
    call keys%get('stiffness', settings%stiffness, 'linear: normal spring of a contact with its like, k_n [N/m]', '(0, inf)')
    call keys%get('youngs_modulus', settings%youngs_modulus, 'hertz: Young''s modulus [Pa]', '(0, inf)')
    call keys%get('poisson_ratio', settings%poisson_ratio, 'hertz: Poisson''s ratio [-]', '(-1, 0.5)')
    call keys%get('restitution', settings%restitution, 'normal restitution of a contact with its like, e_n [-]', '[0.01, 1]')
    call keys%get('friction', settings%friction, 'Coulomb friction of a contact with its like, mu [-]', '[0, 10]')
    call keys%get('rolling_friction', settings%rolling_friction, 'with rolling: mu_r of a contact with its like [-]', '[0, 10]')
    call keys%get('rolling_damping', settings%rolling_damping, 'rolling spring: damping of a contact with its like over the '// &
                  'critical one [-]', '[0, 1]')
    call keys%get('hamaker_constant', settings%hamaker_constant, 'van der Waals: Hamaker''s constant of two of it [J]', '[0, inf)')
    call keys%get('cohesion_energy', settings%cohesion_energy, 'linear cohesion: attraction of two of it over their area of '// &
                  'contact [J/m3]', '[0, inf)')
  end subroutine declare_material

  !> Whether the material has a property of its own, one of those &contact may be required to give.
  elemental function gives(self, property)
    class(material_settings_t), intent(in) :: self
    character(len=*), intent(in) :: property  !< key
    logical :: gives

    select case (property)
    case ('stiffness')
      gives = is_set(self%stiffness)
    case ('youngs_modulus')
      gives = is_set(self%youngs_modulus)
    case ('poisson_ratio')
      gives = is_set(self%poisson_ratio)
    case ('rolling_friction')
      gives = is_set(self%rolling_friction)
    case ('hamaker_constant')
      gives = is_set(self%hamaker_constant)
    case ('cohesion_energy')
      gives = is_set(self%cohesion_energy)
    case default
      gives = .false.
    end select
  end function gives

  !> The keys of the open record &material_pair.
  subroutine declare_pair(settings, former, keys)
    type(pair_settings_t), intent(inout) :: settings
    type(pair_settings_t), intent(in) :: former(:)  !< the records before it
    type(keys_t), intent(inout) :: keys

    integer :: i

    call keys%get_references('materials', settings%ids, settings%materials, 'material')
    call keys%get('stiffness', settings%stiffness, 'linear: normal spring, k_n; else 2 k_i k_j/(k_i + k_j) [N/m]', '(0, inf)')
    call keys%get('restitution', settings%restitution, 'normal restitution, e_n; else sqrt(e_i e_j) [-]', '[0.01, 1]')
    call keys%get('friction', settings%friction, 'Coulomb friction, mu; else sqrt(mu_i mu_j) [-]', '[0, 10]')
    call keys%get('tangential_ratio', settings%tangential_ratio, &
                  'linear: tangential over normal stiffness; else that of &contact [-]', '(0, 2]')
    call keys%get('tangential_damping_ratio', settings%tangential_damping_ratio, &
                  'tangential over normal damping; else that of &contact [-]', '[0, 2]')
    call keys%get('rolling_friction', settings%rolling_friction, 'with rolling: mu_r; else sqrt(mu_r,i mu_r,j) [-]', '[0, 10]')
    call keys%get('rolling_damping', settings%rolling_damping, 'rolling spring: damping over the critical one, eta; '// &
                  'else sqrt(eta_i eta_j) [-]', '[0, 1]')
    call keys%get('hamaker_constant', settings%hamaker_constant, 'van der Waals: Hamaker''s constant, A; else sqrt(A_i A_j) [J]', &
                  '[0, inf)')
    call keys%get('cohesion_energy', settings%cohesion_energy, 'linear cohesion: attraction over area of contact, k; '// &
                  'else sqrt(k_i k_j) [J/m3]', '[0, inf)')
    if (any(settings%materials == 0)) return
    do i = 1, size(former)
      if (.not. (all(former(i)%materials == settings%materials) .or. &
                 all(former(i)%materials(2:1:-1) == settings%materials))) cycle
      call keys%require(.false., 'materials', 'the pair is given twice, first at ' &
                        //keys%file%records(keys%file%find('material_pair', i))%place)
      return
    end do
  end subroutine declare_pair

end module material_settings
